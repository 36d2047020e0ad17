"""`limbd zero`."""

import argparse
from collections.abc import Mapping
from pathlib import Path

from daemon.commands.options import add_device_options, given, not_negative

#: A few stretches to compare, and what is kept in memory.
_SHORTEST_S, _LONGEST_S = 0.5, 60.0

#: As it stands in the help.
EXAMPLE = "limbd zero --port /dev/ttyUSB0 --arm my-arm.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add_device_options(parser)
    add = parser.add_argument
    add("--seconds", type=_seconds, default=2.0, metavar="S", help="how long to measure (default 2)")
    add("--out", type=Path, metavar="FILE", help="where the arm goes (default: its own file)")
    parser.set_defaults(action=zero)


def zero(arguments: argparse.Namespace) -> Mapping[str, object]:
    """Measure the sensors' biases."""
    from daemon.config.config import load_setup
    from daemon.zero_offset.zero_offset import zero_sensors

    return zero_sensors(load_setup(arguments.config, given(arguments)), arguments.seconds, arguments.out)


def _seconds(text: str) -> float:
    value = not_negative(text)
    if not _SHORTEST_S <= value <= _LONGEST_S:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from {_SHORTEST_S:g} to {_LONGEST_S:g}")
    return value
