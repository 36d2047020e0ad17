"""How fast the torque fit is, beside its peers and with a hundred million samples: writes docs/benchmarks.md.

Each benchmark runs in a process of its own, one after the other, with one thread of BLAS, so that times can be
compared; ratios are what lasts, seconds are those of the machine.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from benchmarks.torque_fit import GENERATIONS, POPULATION
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, emit, run_command, say

PACKAGES = ("numpy", "scipy", "numba", "pin", "figaroh", "pymoo", "deap", "cma")
SINGLE = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_TEXT = """# How fast

`make bench` writes this page: {cores} cores of {processor}, Python {python};
{packages}.
Everything was measured in one run, each benchmark by itself. Times are the processor's, of one thread, except
where it says otherwise. The seconds are this machine's, and a busy machine stretches them (on average {load:.1f}
programs wanted its {cores} cores); the ratios are what to look at.

## From {samples:,} samples to {parameters} parameters

The two-joint arm, samples as arrays of angles, velocities, accelerations and torques. `benchmarks/peers.py`

| limbcal | seconds |
|---|---|
| regressor's rows, all 24 columns, kept | {regressor:.3g} |
| regressor's rows and their sums | {reduce:.3g} |
| {generations} generations of {population} on the sums | {search:.3g} |
| **samples to parameters** | **{all:.3g}** |

| regressor of all samples | seconds | times our rows | times our rows and sums |
|---|---|---|---|
{regressors}

Peers were timed on {some:,} samples and their time taken in proportion; the pinocchio model and figaroh's builder
were made beforehand, and their torques are checked against ours.

| {generations} generations of {population} | each individual, each sample | in matrix products | on our sums |
|---|---|---|---|
{searches}

Seconds, and in brackets how many times what limbcal takes from samples to parameters. *Each individual, each
sample*: `sum((W @ p - tau)**2)` with the rows W in memory, as one writes it. *Matrix products*: a whole generation
at a time in pieces that stay in the cache, which is the fastest that samples can be had in numpy. *On our sums*:
the same cost from W'W and W'tau; the rest is the library's own time. A search on samples was run for some
{cap:g} s, at least two generations, and taken in proportion to {evaluations:,} evaluations. Those on sums were run
to the end where that takes no longer; pycma ends by itself when it has converged. All search the same box, with
the settings that their documentation begins with.

How far the searches on the sums came, as the excess of the cost above the optimum:

| search | evaluations | seconds | excess |
|---|---|---|---|
{ends}

## A hundred million samples

`benchmarks/hundred_million.py` makes a motion and its noisy torque block by block, reduces it as it goes, and fits
the parameters: {million_samples:,} samples in {million_seconds:.0f} s by the clock, {million_cpu:.0f} s of
processor on two threads, at most {million_memory:.0f} MB of memory, compiled code and libraries included. No
parameter is off by more than {million_error:.1f} of its standard errors.

## A generation costs the same for any number of samples

| samples | one generation [us] |
|---|---|
{sizes}
"""


def run(name: str, *options: str) -> dict[str, Any]:
    """Run one benchmark in a process of its own and return its document."""
    say(f"running benchmarks.{name}")
    command = [sys.executable, "-W", "ignore", "-m", f"benchmarks.{name}", "--json", *options]
    done = subprocess.run(command, env=os.environ | SINGLE, stdout=subprocess.PIPE, check=True)
    document: dict[str, Any] = json.loads(done.stdout)
    return document


def page(peers: Mapping[str, Any], million: Mapping[str, Any], sizes: Mapping[str, float], cap_s: float) -> str:
    """Return the page."""
    ours = peers["ours"]
    whole = ours["samples to parameters"]
    regressors = [
        f"| {name} | {number(took)} | {number(took / ours['regressor'])} "
        f"| {number(took / ours['regressor and sums'])} |"
        for name, took in peers["regressors"].items()
    ]
    searches, ends = [], []
    for name, kinds in peers["searches"].items():
        times = [timed["seconds"] for timed in kinds.values()]
        searches.append(f"| {name} | " + " | ".join(f"{number(t)} ({number(t / whole)}×)" for t in times) + " |")
        sums = kinds["sums"]
        took = sums["seconds"] * sums["evaluations"] / (GENERATIONS * POPULATION)
        ends.append(f"| {name} | {sums['evaluations']:,} | {number(took)} | {sums['excess']:.1e} |")
    return _TEXT.format(
        cores=os.cpu_count(),
        processor=processor(),
        python=sys.version.split()[0],
        packages=", ".join(f"{name} {version(name)}" for name in PACKAGES),
        samples=peers["samples"],
        parameters=peers["parameters"],
        regressor=ours["regressor"],
        reduce=ours["regressor and sums"],
        search=ours["search"],
        all=whole,
        generations=GENERATIONS,
        population=POPULATION,
        evaluations=GENERATIONS * POPULATION,
        some=peers["some_samples"],
        load=peers["load"],
        cap=cap_s,
        regressors="\n".join(regressors),
        searches="\n".join(searches),
        ends="\n".join(ends),
        million_samples=million["samples"],
        million_seconds=million["seconds"],
        million_cpu=million["cpu_seconds"],
        million_memory=million["peak_megabytes"],
        million_error=million["worst_error_in_std"],
        sizes="\n".join(f"| {int(n):,} | {took:.1f} |" for n, took in sizes.items()),
    )


def number(value: float) -> str:
    """Return a number as a table has it: three digits, and no powers of ten."""
    return f"{value:,.0f}" if value >= 100.0 else f"{value:.3g}"


def processor() -> str:
    """Return what the machine calls its processor."""
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return "an unnamed processor"


def measure(options: argparse.Namespace) -> Document:
    """Run all and write the page."""
    peers = run("peers", "--cap", str(options.cap)) | {"load": os.getloadavg()[1]}
    million = run("hundred_million")
    fit = run("torque_fit")
    text = page(peers, million, fit["us_per_generation"], options.cap)
    if options.out is None:
        emit(text)
    else:
        options.out.write_text(text, encoding="utf-8")
    return {"peers": peers, "hundred_million": million, "torque_fit": fit}


def main(argv: list[str] | None = None) -> int:
    """Run the benchmarks."""
    parser = Parser(prog="python -m benchmarks.speed", description=__doc__, parents=[common_options()])
    parser.add_argument("--cap", type=float, default=10.0, help="seconds for each of the peers' searches (10)")
    parser.add_argument("--out", type=Path, help="the page (stdout)")
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
