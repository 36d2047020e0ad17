"""`fitter sums`: recordings of any length to the sums that a torque fit needs, and sums to their sum."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from rich.progress import Progress

from arm.model import Arm
from fitter.commands.arm_option import questioned_arm
from fitter.commands.options import add_arm, add_as_tracked, add_columns, add_out, at_least, make_room, positive
from fitter.data.trial import Role
from fitter.regression_sums.reduction import Reduction, reduce_trials
from fitter.regression_sums.saved_sums import ArmSums, add_sums, load_sums, save_sums
from limbcal.arguments import Parser
from limbcal.command import Document, console, say_notes, show
from limbcal.note import documents

#: As it stands in the help.
EXAMPLE = "fitter sums make trials --arm my-arm.toml --out sums.npz"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter sums` takes."""
    commands = parser.add_subparsers(required=True, metavar="make|add", parser_class=Parser)
    making = commands.add_parser("make", help="reduce trials to sums", description="reduce trials to sums")
    making.add_argument("data", nargs="+", type=Path, metavar="DATA", help="trials to learn from: files, folders")
    add_arm(making)
    add_columns(making)
    add_as_tracked(making)
    making.add_argument("--cutoff-hz", type=positive, metavar="F", help="corner of the filter (found in the data)")
    making.add_argument("--workers", type=at_least(1), default=1, metavar="N", help="processes (1)")
    making.add_argument("--dask", metavar="tcp://…", help="scheduler of a Dask cluster that does it instead")
    making.set_defaults(action=make)
    adding = commands.add_parser("add", help="add sums up", description="add sums up")
    adding.add_argument("parts", nargs="+", type=Path, metavar="SUMS", help="sums of one arm, of different trials")
    adding.set_defaults(action=add)
    for command in (making, adding):
        add_out(command, "the sums, as NPZ; `fitter dynamics` takes them as trials to learn from")
        for option in ("--json", "--debug"):  # as common_options has them, but not undone where they came before
            command.add_argument(
                option, action="store_true", default=argparse.SUPPRESS, help=f"as `fitter {option}`"
            )


def reduced(
    arguments: argparse.Namespace, arm: Arm, data: Sequence[Path], omitted: Role | None = "evaluate"
) -> Reduction:
    """Reduce trials to sums, with a progress bar.

    Parameters
    ----------
    arguments : argparse.Namespace
        With the columns, filter and processes that are asked for.
    arm : Arm
    data : sequence of Path
    omitted
        As in `fitter.regression_sums.reduction.reduce_trials`.
    """
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("reducing", total=None)
        return reduce_trials(
            arm,
            data,
            columns=arguments.columns,
            rate_hz=arguments.rate_hz,
            cutoff_hz=arguments.cutoff_hz,
            omitted=omitted,
            as_tracked=arguments.as_tracked,
            workers=arguments.workers,
            dask=arguments.dask,
            progress=lambda done, files: progress.update(task, completed=done, total=files),
        )


def make(arguments: argparse.Namespace) -> Document:
    """Reduce trials and write their sums."""
    arm = questioned_arm(arguments.arm)
    make_room(arguments.out, (".npz",), arguments.data)
    reduction = reduced(arguments, arm, arguments.data)
    say_notes(reduction.notes)
    save_sums(arguments.out, reduction.saved)
    corners = {"cutoff_hz": reduction.cutoff_hz, "band_hz": reduction.band_hz}
    return _document(arguments.out, reduction.saved) | corners | {"notes": documents(reduction.notes)}


def add(arguments: argparse.Namespace) -> Document:
    """Add sums up and write the result."""
    make_room(arguments.out, (".npz",))
    paths: list[Path] = arguments.parts
    saved = add_sums([load_sums(path) for path in paths], [str(path) for path in paths])
    save_sums(arguments.out, saved)
    return _document(arguments.out, saved)


def _document(out: Path, saved: ArmSums) -> dict[str, object]:
    show(f"{out}: {saved.sums.samples} samples of {len(saved.trials)} trial(s)")
    return {
        "out": str(out),
        "samples": saved.sums.samples,
        "trials": list(saved.trials),
        "parameters": list(saved.equation.base_names),
    }
