"""`limbd recover`."""

import argparse
from collections.abc import Mapping
from pathlib import Path

#: As it stands in the help.
EXAMPLE = "limbd recover recordings/run.mcap"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("file", type=Path, metavar="FILE")
    parser.add_argument("--out", type=Path, metavar="FILE", help="default NAME.recovered.mcap beside it")
    parser.set_defaults(action=recover)


def recover(arguments: argparse.Namespace) -> Mapping[str, object]:
    """Make a clean file and prove it."""
    from daemon.recording.recovery import recover as recovered

    return recovered(arguments.file, arguments.out)
