"""Hidden cases, diagnosed by the hundred: the confusion matrix of `fitter diagnose`.

Every case is drawn by a seed with a simulator that is not the fitter's (`tests/diagnosis`), written to files, and
diagnosed by the command; the truth stays here. One JSON line a case goes to a log, crashed cases with their
traceback. What the page is made of is kept beside it, a short line a case with the code's commit, and the cases of
another run are added to it. ``--write-case`` writes one case's files, to look at it.
"""

import argparse
import json
import multiprocessing
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

import fitter.single_thread  # noqa: F401 - the processes that it starts inherit it
from benchmarks.diagnosis_case import Job, run
from benchmarks.diagnosis_page import brief, goals, page
from fitter.dynamics.parallel import be_worker
from fitter.side_by_side import work_alone
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, emit, run_command, say
from limbcal.errors import ConfigError
from tests.diagnosis.hidden_cases import KINDS, draw_case
from tests.diagnosis.hidden_effects import EFFECTS, OUTSIDE

#: A case that was under way when a process died is tried so often.
_TRIES = 2
#: Seeds of two kinds never meet.
_APART = 1_000_000


def jobs(counts: dict[str, int], seed: int, effect: str | None) -> list[Job]:
    """Return the cases: so many of each kind, their effects in turn from that of the seed on.

    The kinds alternate, each as often as it has cases, so a log that was cut short holds some of all.
    """
    turns = {"one": list(EFFECTS), "outside": list(OUTSIDE), "nothing": [None], "two": list(EFFECTS)}
    places = sorted(((k + 0.5) / count, kind, k) for kind, count in counts.items() for k in range(count))
    return [
        Job(kind, seed + _APART * KINDS.index(kind) + k, effect or turns[kind][(seed + k) % len(turns[kind])])
        for _, kind, k in places
    ]


def run_all(todo: list[Job], workers: int, limit_s: float) -> Iterator[dict[str, Any]]:
    """Yield the lines of the cases as they are done, whatever happens to the processes that run them."""
    spawn, tries = multiprocessing.get_context("spawn"), dict.fromkeys(todo, 0)
    while tries:
        with ProcessPoolExecutor(workers, mp_context=spawn, initializer=_begin, initargs=(workers,)) as pool:
            futures = {pool.submit(run, job, limit_s): job for job in tries}
            for future in as_completed(futures):
                job = futures[future]
                try:
                    line = future.result()
                except BrokenProcessPool:
                    continue  # the others that waited in this pool end here too: a new one takes them
                del tries[job]
                yield line
        begun = list(tries)[:workers]  # in order of submission, so these were under way when the process died
        for job in begun:
            tries[job] += 1
            if tries[job] >= _TRIES:
                del tries[job]
                where = {"key": job.key, "kind": job.kind, "seed": job.seed, "effect": job.effect}
                yield where | {"error": "the process that ran it died"}


def _begin(workers: int) -> None:
    be_worker()
    if workers > 1:
        work_alone()


def read_log(path: Path) -> list[dict[str, Any]]:
    """Return the lines of a log; none where there is no file."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def measure(options: argparse.Namespace) -> Document:
    """Run the cases and write the page."""
    counts = dict(
        zip(options.kinds, options.cases * (len(options.kinds) if len(options.cases) == 1 else 1), strict=False)
    )
    if len(counts) != len(options.kinds):
        raise ConfigError(
            f"--cases has {len(options.cases)} numbers, expected one or one a kind ({len(options.kinds)})"
        )
    options.log.parent.mkdir(parents=True, exist_ok=True)
    todo = jobs(counts, options.seed, options.effect)
    done = [line for line in read_log(options.log) if options.resume]
    keys = {line["key"] for line in done}
    todo = [job for job in todo if job.key not in keys]
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as progress, options.log.open("a" if options.resume else "w") as log:
        task = progress.add_task("diagnosing", total=len(todo))
        for line in run_all(todo, options.workers, options.limit):
            log.write(json.dumps(line) + "\n")
            log.flush()
            done.append(line)
            right = sum(bool(one.get("score", {}).get("right")) for one in done)
            progress.update(task, advance=1, description=f"right {right} of {len(done)}")
    record = options.out.with_suffix(".jsonl")
    kept = list({line["key"]: line for line in [*read_log(record), *map(brief, done)]}.values())
    record.write_text("".join(json.dumps(line) + "\n" for line in kept), encoding="utf-8")
    options.out.write_text(page(kept), encoding="utf-8")
    say(f"{options.out}: {len(kept)} cases; {record}: one line each; {options.log}: all about {len(done)} of them")
    if not options.json:
        emit(goals(done))
    return {"cases": len(done), "right": sum(bool(line.get("score", {}).get("right")) for line in done)}


def write_case(options: argparse.Namespace) -> Document:
    """Write one case: ``learn.npz``, ``evaluate.npz``, ``arm.toml`` and ``truth.json``."""
    case = draw_case(options.write_case, options.kinds[0], options.effect)
    case.write(options.out)
    case.write_truth(options.out / "truth.json")
    say(f"{options.out}: learn.npz, evaluate.npz, arm.toml, truth.json")
    return case.truth


def act(options: argparse.Namespace) -> Document:
    """Write one case, or measure many."""
    unknown = set(options.kinds) - set(KINDS)
    if unknown:
        raise ConfigError(f"--kinds: {', '.join(sorted(unknown))}; expected {', '.join(KINDS)}")
    if options.effect is not None and options.effect not in {**EFFECTS, **OUTSIDE}:
        raise ConfigError(f"--effect is {options.effect!r}, expected one of {', '.join([*EFFECTS, *OUTSIDE])}")
    return measure(options) if options.write_case is None else write_case(options)


def _numbers(text: str) -> list[int]:
    return [int(number) for number in text.split(",")]


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(prog="benchmarks.diagnosis", description=__doc__, parents=[common_options()])
    add = parser.add_argument
    add("--cases", type=_numbers, default=[22], metavar="N[,N…]", help="how many of each kind")
    add("--kinds", "--kind", type=lambda text: text.split(","), default=["one"], help=f"of {', '.join(KINDS)}")
    add("--effect", help="only this one; all in turn unless given")
    add("--seed", type=int, default=0)
    add("--workers", type=int, default=2)
    add("--limit", type=float, default=600.0, metavar="SECONDS", help="a case that takes longer has failed")
    add("--log", type=Path, default=Path("out/diagnosis.jsonl"), help="one JSON line a case")
    add("--resume", action="store_true", help="leave out what the log has already")
    add("--write-case", type=int, metavar="SEED", help="write one case's files to --out and stop")
    add("--out", type=Path, default=Path("docs/diagnosis.md"))
    parser.set_defaults(action=act)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
