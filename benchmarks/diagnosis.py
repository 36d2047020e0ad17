"""How often the diagnosis names what was hidden in simulated arms.

Every case is drawn by a seed with a simulator that is not the fitter's (`benchmarks.hidden_arms`), written to
files and diagnosed; the truth stays here. Results are those of one commit: a line a case in
``benchmarks/results/diagnosis-<commit>.jsonl``. What that file has already is not run again, unless the checkout
differs from its commit: then the file begins anew. ``--page`` makes docs/diagnosis.md of one such file, and
``--write-case`` writes one case's files, to look at it.
"""

import argparse
import sys
from pathlib import Path

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from benchmarks.case_pool import Guarded, run_all
from benchmarks.diagnosis_case import Job, run
from benchmarks.diagnosis_page import by_effect, figures, page, pairs, wrong_ones
from benchmarks.hidden_arms.cases import KINDS, draw_case
from benchmarks.hidden_arms.effects import EFFECTS, OUTSIDE
from benchmarks.record import append, commit, known_lines, path_of, read_lines
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, emit, run_command, say
from limbcal.errors import ConfigError, DataError

#: Seeds of two kinds never meet.
_APART = 1_000_000
#: Whose turn it is in each kind.
_TURNS: dict[str, list[str | None]] = {
    "one": list(EFFECTS),
    "outside": list(OUTSIDE),
    "nothing": [None],
    "two": list(EFFECTS),
}


def jobs(kind: str, cases: int, seed: int, effect: str | None) -> list[Job]:
    """Return the cases of one kind, their effects in turn from that of the seed on."""
    turns = [effect] if effect is not None else _TURNS[kind]
    apart = _APART * KINDS.index(kind)
    return [Job(kind, seed + apart + k, turns[(seed + k) % len(turns)]) for k in range(cases)]


def measure(options: argparse.Namespace) -> Document:
    """Run the cases of one kind and say what came of them."""
    path = path_of("diagnosis", "jsonl")
    known = known_lines(path)
    asked = jobs(options.kind, options.cases or len(_TURNS[options.kind]), options.seed, options.effect)
    todo = [job for job in asked if job.key not in known]
    lines = [known[job.key] for job in asked if job.key in known]
    bar = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*bar, TimeElapsedColumn(), TimeRemainingColumn(), console=console) as progress:
        task = progress.add_task("diagnosing", total=len(todo))
        for job, line in run_all(todo, Guarded(run, options.limit), options.workers):
            whole = {**job.fields, "commit": commit(), **line}
            append(path, whole)
            lines.append(whole)
            right = sum(bool(one.get("score", {}).get("right")) for one in lines)
            progress.update(task, advance=1, description=f"right {right} of {len(lines)}")
    lines.sort(key=lambda line: int(line["seed"]))
    say(f"{path}: {len(read_lines(path))} cases of this commit")
    if not options.json:
        of_each = pairs if options.kind == "two" else by_effect
        emit("\n".join([figures(lines), of_each(lines), wrong_ones(lines)]))
    return {"commit": commit(), "cases": lines}


def write_case(options: argparse.Namespace) -> Document:
    """Write one case: ``learn.npz``, ``evaluate.npz``, ``arm.toml`` and ``truth.json``."""
    case = draw_case(options.seed, options.kind, options.effect)
    case.write(options.write_case)
    case.write_truth(options.write_case / "truth.json")
    say(f"{options.write_case}: learn.npz, evaluate.npz, arm.toml, truth.json")
    return case.truth


def write_page(options: argparse.Namespace) -> Document:
    """Make the page of one results file."""
    lines = read_lines(options.page)
    commits = sorted({str(line["commit"]) for line in lines})
    if len(commits) != 1:
        raise DataError(f"{options.page}: it has cases of {len(commits)} commits; expected those of one")
    options.out.write_text(page(lines), encoding="utf-8")
    say(f"{options.out}: {len(lines)} cases of commit {commits[0]}")
    return {"commit": commits[0], "cases": len(lines)}


def act(options: argparse.Namespace) -> Document:
    """Do what was asked for."""
    known = _TURNS[options.kind]
    if options.effect is not None and options.effect not in known:
        raise ConfigError(f"--effect is {options.effect!r}, expected one of {', '.join(map(str, known))}")
    if options.page is not None:
        return write_page(options)
    return measure(options) if options.write_case is None else write_case(options)


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(prog="python -m benchmarks.diagnosis", description=__doc__, parents=[common_options()])
    add = parser.add_argument
    add("--kind", choices=KINDS, default="one", help="what is hidden (default: one effect)")
    add("--cases", type=int, metavar="N", help="how many (default: one an effect)")
    add("--effect", help="only this one; all in turn unless given")
    add("--seed", type=int, default=0)
    add("--workers", type=int, default=1)
    add("--limit", type=float, default=600.0, metavar="SECONDS", help="a case that takes longer has failed")
    add("--write-case", type=Path, metavar="DIR", help="write the files of the seed's case and stop")
    add("--page", type=Path, metavar="RESULTS", help="make the page of a results file and stop")
    add("--out", type=Path, default=Path("docs/diagnosis.md"), help="where the page goes")
    parser.set_defaults(action=act)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
