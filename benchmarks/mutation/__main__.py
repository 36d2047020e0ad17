"""How many small faults the tests notice.

A sample of faults is put into a copy of the checkout, one at a time: a number one more or less, a comparison, an
operator, a condition turned round, a loop never run, an exception not caught. The test file of the module's name
runs, and if it passes, those nearest to it in its package. A fault that none of them notices has survived; where
they take far longer with it than without, it counts as noticed. Test files that are slow without a fault are left
out: where other programs have the processors busy, ``--patience`` keeps them in. A fault for which none remains
is untried.

Results are those of one commit: ``benchmarks/results/mutation-<commit>.jsonl``, a line a fault, which a later call
adds to. Where the checkout differs from its commit they begin anew.
"""

import argparse
import sys
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

from benchmarks.mutation.checkout import Copy
from benchmarks.mutation.mutants import Mutant, mutants_of, sample
from benchmarks.mutation.trial import UNNOTICED, Runner, Trials, summary
from benchmarks.record import append, known_lines, path_of, read_lines
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, emit, run_command
from limbcal.errors import ConfigError

Line = dict[str, Any]

ROOT = Path(__file__).parents[2]
#: What is looked at unless others are asked for.
PACKAGES = ("protocol", "daemon", "playback", "fitter/data", "limbcal", "tracking")


def files_of(root: Path, packages: list[str]) -> list[str]:
    """Return the modules of some packages, or some modules."""
    found = []
    for name in packages:
        place = root / name
        if not place.exists():
            raise ConfigError(
                f"--packages has {name}, which is not there; expected some like {', '.join(PACKAGES)}"
            )
        found += [place] if place.is_file() else sorted(place.rglob("*.py"))
    return [str(file.relative_to(root)) for file in found]


def chosen(options: argparse.Namespace) -> list[Mutant]:
    """Return the faults that are to be tried."""
    paths = files_of(ROOT, options.packages)
    if options.again is None:
        return sample(ROOT, paths, options.sample, options.seed)
    if not options.again.is_file():
        raise ConfigError(f"--again: there is no {options.again}")
    keys = {line["key"] for line in read_lines(options.again) if line.get("outcome") in UNNOTICED}
    every = (one for path in paths for one in mutants_of(path, (ROOT / path).read_text(encoding="utf-8")))
    return [mutant for mutant in every if mutant.key in keys]


def act(options: argparse.Namespace) -> Document:
    """Try faults, and say which survived."""
    for name in ("sample", "nearest", "patience"):
        if not getattr(options, name) >= 1:
            raise ConfigError(f"--{name} is {getattr(options, name)}; expected 1 or more")
    todo = chosen(options)
    path = path_of("mutation", "jsonl")
    known = known_lines(path)
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    work = ROOT / "out" / "mutation"
    copy = Copy(ROOT, work / "checkout")
    with (
        Runner(copy, work / "last_run.txt") as runner,
        Progress(*columns, TextColumn("{task.description}"), console=console) as bar,
    ):
        task = bar.add_task("", total=len(todo))
        trials = Trials(runner, known, lambda line: append(path, line), options.nearest, options.patience)
        for mutant in todo:
            if mutant.key not in known:
                bar.update(task, description=f"{mutant.path}:{mutant.line}")
                known[mutant.key] = trials.run(mutant)
                append(path, known[mutant.key])
            bar.update(task, advance=1)
    lines = [known[mutant.key] for mutant in todo]
    if not options.json:
        emit(f"seed {options.seed}, {path}\n{summary(lines)}")
    return {"seed": options.seed, "file": str(path), "mutants": lines}


def main(argv: list[str] | None = None) -> int:
    """Run the mutation tests and return the exit code."""
    parser = Parser(prog="python -m benchmarks.mutation", description=__doc__, parents=[common_options()])
    add = parser.add_argument
    add("--sample", type=int, default=200, metavar="N", help="faults to try (default 200)")
    add("--seed", type=int, default=0, help="of the sample (default 0)")
    add("--packages", nargs="+", default=list(PACKAGES), metavar="PATH", help=f"default: {' '.join(PACKAGES)}")
    add("--nearest", type=int, default=3, metavar="N", help="test files tried; 1: the nearest alone (default 3)")
    add("--patience", type=float, default=1.0, metavar="F", help="times as long that all may take (1)")
    add("--again", type=Path, metavar="FILE", help="only what survived in an earlier results file")
    parser.set_defaults(action=act)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
