"""How long a torque fit of the paper's size takes: 1,054,688 samples, 8 parameters, 1000 generations of 100.

The table's first part goes from arrays to the answer, base parameters and standard errors included; the
second shows that a generation costs the same whatever the number of samples.
"""

import argparse
import sys
import time
from dataclasses import replace
from functools import partial

import numpy as np
from rich.table import Table

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.model import Arm, Control, Floats
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from benchmarks.timing import seconds
from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.torque_problem import torque_problem
from fitter.dynamics.torque_search import fit_sums
from fitter.regression_sums.torque_sums import TorqueSums, add_up
from fitter.regression_sums.trial_sums import trial_sums
from fitter.search.genetic import GeneticAlgorithm
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, run_command

SAMPLES = 1_054_688
POPULATION, GENERATIONS = 100, 1000
SIZES = (1_000, 10_000, 100_000, 1_000_000)
NOISE_N_M = 0.02
REPEATS = 3


def bench_trials(arm: Arm, samples: int) -> list[Trial]:
    """Return the bench's learning trials with noise on the torque, every 32 us as the paper counts them."""
    rng = np.random.default_rng(0)
    bench = replace(Bench(), rate_hz=31_250.0, learning=5, evaluating=0)
    trials, left = [], samples
    for i, motion in enumerate(motions(arm, bench, 0)):
        n = min(left, len(motion.t))
        tau = motion.tau[:n] + NOISE_N_M * rng.normal(size=(n, arm.n_joint))
        trials.append(Trial(f"bench#{i}", motion.t[:n], 3.2e-5, motion.q[:n], motion.dq[:n], motion.ddq[:n], tau))
        left -= n
    return trials


def breed(sums: TorqueSums, prior: Floats, generations: int = GENERATIONS) -> None:
    """Run a search of its own on given sums."""
    problem = torque_problem(sums, prior)
    search = GeneticAlgorithm(*problem.bounds(), np.random.default_rng(0), POPULATION)
    for _ in range(generations):
        search.tell(problem.cost(search.ask()))


def measure(_options: argparse.Namespace) -> Document:
    """Measure, show the table and return its numbers."""
    arm = replace(load_arm("dd-arm"), control=Control())
    trials = bench_trials(load_arm("dd-arm"), SAMPLES)
    base = structural_parameters(arm)
    prior = base.combination @ standard_parameters(arm)

    def reduce() -> TorqueSums:
        return add_up([trial_sums(arm, base, trial) for trial in trials])

    def answer() -> DynamicsFit:
        return fit_sums(arm, base, reduce(), population=POPULATION, generations=GENERATIONS)

    sums, fit = reduce(), answer()  # compiles
    timed = partial(seconds, repeats=REPEATS, clock=time.perf_counter)
    stages = {
        "arrays to sums": timed(reduce),
        f"{GENERATIONS} generations of {POPULATION}": timed(partial(breed, sums, prior)),
        "arrays to answer": timed(answer),
    }
    worst = max(abs(fit.parameters[name].value - true) for name, true in zip(base.names, prior, strict=True))
    sizes = {}
    for size in SIZES:
        some = [thinned(trial, SAMPLES // size) for trial in trials]
        part = add_up([trial_sums(arm, base, trial) for trial in some])
        sizes[part.samples] = 1e6 * timed(partial(breed, part, prior)) / GENERATIONS
    show(fit.samples, len(base.names), stages, sizes)
    return {
        "samples": fit.samples,
        "parameters": len(base.names),
        "seconds": stages,
        "us_per_generation": {str(samples): took for samples, took in sizes.items()},
        "worst_error": worst,
    }


def thinned(trial: Trial, step: int) -> Trial:
    """Return every so manieth sample of a trial."""
    part = slice(None, None, step)
    tau = None if trial.tau is None else trial.tau[part]
    return replace(
        trial,
        t=trial.t[part],
        dt_s=step * trial.dt_s,
        q=np.ascontiguousarray(trial.q[part]),
        dq=np.ascontiguousarray(trial.dq[part]),
        ddq=np.ascontiguousarray(trial.ddq[part]),
        tau=tau,
    )


def show(samples: int, parameters: int, stages: dict[str, float], sizes: dict[int, float]) -> None:
    """Print both parts of the table."""
    table = Table(title=f"Torque fit: {samples:,} samples, {parameters} parameters")
    table.add_column("job")
    table.add_column("time", justify="right")
    for name, took in stages.items():
        table.add_row(name, f"{took:.3f} s")
    table.add_section()
    for size, took in sizes.items():
        table.add_row(f"one generation after {size:,} samples", f"{took:.1f} us")
    console.print(table)


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.torque_fit", description=__doc__, parents=[common_options()])
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
