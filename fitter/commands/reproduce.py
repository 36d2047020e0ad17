"""`fitter reproduce`: the paper's experiments, side by side with its numbers."""

import argparse
import os
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from fitter.commands.options import at_least
from fitter.experiments.experiment import Settings
from fitter.experiments.reproduction import EXPERIMENTS, Outcome, reproduce
from fitter.experiments.reproduction_report import document_of, write_report
from limbcal.command import Document, console, show
from limbcal.errors import ConfigError, DeviceError
from limbcal.suggestion import did_you_mean

_ALL = "all"
#: As many as the experiments are worth parting into.
_JOBS = 2

#: As it stands in the help.
EXAMPLE = "fitter reproduce table3 fig7 --out reproduction"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter reproduce` takes."""
    parser.add_argument(
        "experiments", nargs="+", metavar="EXPERIMENT", help=f"{', '.join(EXPERIMENTS)}, or {_ALL}"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="where reproduction.md, .html, .json and PNGs go"
    )
    parser.add_argument("--seed", type=at_least(0), default=0, help="of motions, noise and searches (0)")
    parser.add_argument(
        "--samples",
        type=at_least(1000),
        metavar="N",
        help="samples of the learning set where the paper gives no number of its own (1054688, in Fig. 6 100000)",
    )
    parser.add_argument(
        "--jobs", type=at_least(1), default=min(_JOBS, os.cpu_count() or 1), metavar="N", help="processes (2)"
    )
    parser.add_argument("--quick", action="store_true", help="all steps on little data: to see whether it works")
    parser.set_defaults(action=reproduction)


def reproduction(arguments: argparse.Namespace) -> Document:
    """Run the experiments, write the report and say what they found; the tables are too wide for a terminal."""
    names = _chosen(arguments.experiments)
    out: Path = arguments.out
    _make_directory(out)
    settings = Settings(arguments.seed, arguments.samples, arguments.quick)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("reproducing", total=len(names))

        def reported(_name: str, what: str) -> None:
            bar.update(task, advance=0 if what else 1, description=what or "reproducing")

        outcomes = reproduce(names, settings, arguments.jobs, reported)
    document = document_of(outcomes, arguments.seed)
    write_report(outcomes, document, _command(arguments, names), out)
    for outcome in outcomes:
        _print(outcome)
    show(f"report: {out / 'reproduction.html'}")
    for outcome in outcomes:
        if outcome.error is not None:
            raise outcome.error
    return document


def _chosen(given: list[str]) -> list[str]:
    unknown = [name for name in given if name not in (*EXPERIMENTS, _ALL)]
    if unknown:
        raise ConfigError(
            f"no experiment is called {', '.join(unknown)}; there are {', '.join(EXPERIMENTS)}, and {_ALL}"
            f"{did_you_mean(unknown[0], EXPERIMENTS)}"
        )
    return [name for name in EXPERIMENTS if name in given or _ALL in given]


def _make_directory(out: Path) -> None:
    """Make sure that there is a place for the report, before minutes go into what is to be in it."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = "it is a file" if out.is_file() else error.strerror
        raise DeviceError(f"{out}: no directory can be made there: {reason}") from error
    if not os.access(out, os.W_OK):
        raise DeviceError(f"{out}: cannot be written: permission denied")


def _command(arguments: argparse.Namespace, names: list[str]) -> str:
    said = [_ALL] if len(names) == len(EXPERIMENTS) else names
    options = [f"--seed {arguments.seed}"] if arguments.seed else []
    options += [f"--samples {arguments.samples}"] if arguments.samples else []
    options += ["--quick"] if arguments.quick else []
    return " ".join(["fitter reproduce", *said, "--out DIR", *options])


def _print(outcome: Outcome) -> None:
    found = outcome.experiment
    if found is None:
        show(f"{outcome.name}: {outcome.error}")
        return
    show(found.title)
    for sentence in found.findings:
        show(f"  {sentence}")
