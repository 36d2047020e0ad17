"""Options that several commands share."""

import argparse
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from arm.model import Arm, Floats
from limbcal.errors import ConfigError, DeviceError
from protocol.tables.files import SUFFIXES

#: What a motion is written as.
MOTION_SUFFIXES = (".csv", ".parquet", ".npz")
#: The genetic algorithm's survivors and mutants are shares of a population; of fewer nothing is left.
SMALLEST_POPULATION = 10


def add_arm(parser: argparse.ArgumentParser, required: bool = True) -> None:
    """Add ``--arm``."""
    parser.add_argument(
        "--arm", required=required, metavar="A", help="arm file, or the name of a built-in arm such as dd-arm"
    )


def add_columns(parser: argparse.ArgumentParser) -> None:
    """Add ``--columns`` and ``--rate-hz``."""
    parser.add_argument(
        "--columns",
        metavar="MAP",
        help='where foreign columns are, such as "t=time,q=pos{j}:deg,tau=torque{j}-pulse{j}"; t=0.001 is a step; '
        "gains and switches of the drives (kp=gain,on=enabled), rows and cells of .mat and .json: docs/data.md",
    )
    parser.add_argument(
        "--rate-hz", type=positive, metavar="R", help="rate to resample to, or of samples that come without a time"
    )


def add_as_tracked(parser: argparse.ArgumentParser) -> None:
    """Add the option that takes recorded motions as they are."""
    parser.add_argument(
        "--as-tracked",
        action="store_true",
        help="take motions of recordings as the daemon's tracker gave them out, not estimated again from readings",
    )


def add_out(parser: argparse.ArgumentParser, help_text: str) -> None:
    """Add ``--out FILE``."""
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help=help_text)


def add_report(parser: argparse.ArgumentParser) -> None:
    """Add ``--report FILE``."""
    parser.add_argument(
        "--report", type=Path, metavar="FILE", help="a page to hand on (.html): results, symbols, what was assumed"
    )


def make_room(out: Path, suffixes: Sequence[str] = (), read: Iterable[Path] = ()) -> None:
    """Make sure that a file can be written, before an hour goes into what is to be in it.

    Parameters
    ----------
    out : Path
    suffixes : sequence of str, optional
        Those that it may have; any by default.
    read : iterable of Path, optional
        The files and folders that are read, none of which it may replace.

    Raises
    ------
    ConfigError
        If the suffix is none of those given, or if the file is read.
    DeviceError
        If there is no place for it.
    """
    if suffixes and out.suffix.lower() not in suffixes:
        raise ConfigError(f"{out}: the suffix is {out.suffix!r}, expected one of {', '.join(suffixes)}")
    if out.exists() and any(_is_of(out.resolve(), one.resolve()) for one in read):
        raise ConfigError(f"{out}: this file is read, and the result would take its place; expected another")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = "Not a directory" if isinstance(error, FileExistsError) else error.strerror
        raise DeviceError(f"{out}: cannot be written: {reason}") from error
    if out.is_dir() or not os.access(out if out.exists() else out.parent, os.W_OK):
        reason = "it is a directory" if out.is_dir() else "permission denied"
        raise DeviceError(f"{out}: cannot be written: {reason}")


def _is_of(file: Path, read: Path) -> bool:
    """Say whether a file is one that is read, or one of those that are read of a folder."""
    return file == read or (file.suffix.lower() in SUFFIXES and read in file.parents)


def positive(text: str) -> float:
    """Read a number above zero."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return value


def _of_a_person(low: float, high: float, unit: str) -> Callable[[str], float]:
    """Return what reads a number of a person and refuses one that is none in its unit."""

    def read(text: str) -> float:
        value = positive(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text!r} is no person's, expected {low:g} to {high:g} {unit}")
        return value

    return read


#: A person's height and mass: from an infant born too early to the tallest and the heaviest on record.
height_m, mass_kg = _of_a_person(0.25, 2.75, "m"), _of_a_person(0.4, 650.0, "kg")


def at_least(smallest: int) -> Callable[[str], int]:
    """Return what reads a whole number that is not below some other."""

    def whole(text: str) -> int:
        if not (text.isdecimal() and int(text) >= smallest):
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least {smallest}")
        return int(text)

    return whole


def add_search(parser: argparse.ArgumentParser, population: str, generations: int) -> None:
    """Add ``--seed``, ``--population`` and ``--generations`` of the genetic algorithm."""
    parser.add_argument("--seed", type=at_least(0), default=0, help="of the genetic algorithm (0)")
    parser.add_argument(
        "--population", type=at_least(SMALLEST_POPULATION), metavar="N", help=f"individuals ({population})"
    )
    parser.add_argument(
        "--generations", type=at_least(1), default=generations, metavar="N", help=f"({generations})"
    )


def require_heeded(arguments: argparse.Namespace, way: str, unheeded: Mapping[str, object]) -> None:
    """Make sure that no option is given that a way of learning does not heed.

    Parameters
    ----------
    arguments : argparse.Namespace
    way : str
        The option that chose it.
    unheeded : mapping of str to object
        Options that it does not heed, by their names in the arguments, and what they are unless given.

    Raises
    ------
    ConfigError
        If one is, naming all that are.
    """
    given = [f"--{name.replace('_', '-')}" for name, unless in unheeded.items() if vars(arguments)[name] != unless]
    if given:
        raise ConfigError(f"{', '.join(given)}: not heeded with {way}; expected one or the other")


def joint_values(text: str, arm: Arm, option: str) -> Floats:
    """Read one number a joint, such as ``0,1.57``.

    Raises
    ------
    ConfigError
        If there are not as many numbers as the arm has joints.
    """
    try:
        values = np.array([float(part) for part in text.split(",")])
        if not np.isfinite(values).all():
            raise ValueError("not finite")
    except ValueError as error:
        raise ConfigError(f"{option} is {text!r}, expected numbers parted by commas") from error
    if len(values) != arm.n_joint:
        raise ConfigError(f"{option} has {len(values)} numbers, expected one a joint ({arm.n_joint})")
    return values


def pairs(text: str | None, option: str) -> dict[str, str]:
    """Read ``name=value`` pairs parted by commas; a name alone has an empty value.

    Raises
    ------
    ConfigError
        If a name is missing or given twice.
    """
    found: dict[str, str] = {}
    for part in [] if text is None else text.split(","):
        name, _, value = part.strip().partition("=")
        if not name or name in found:
            raise ConfigError(f"{option} is {text!r}, expected each parameter's name once")
        found[name] = value
    return found


def per_joint(values: Floats) -> Sequence[float]:
    """Return plain numbers for JSON."""
    return [float(value) for value in values]


def bounds_of(text: str | None) -> dict[str, tuple[float, float]]:
    """Read bounds such as ``a1=0:0.5,a2=0:0.5``.

    Raises
    ------
    ConfigError
        If a bound is not two numbers.
    """
    found = {}
    for name, value in pairs(text, "--bounds").items():
        low, _, high = value.partition(":")
        found[name] = (_number(low, f"--bounds {name}"), _number(high, f"--bounds {name}"))
    return found


def fixed_of(text: str | None) -> dict[str, float]:
    """Read known values such as ``D1=0,D2=0.1``.

    Raises
    ------
    ConfigError
        If a value is not a number.
    """
    return {name: _number(value, f"--fix {name}") for name, value in pairs(text, "--fix").items()}


def _number(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ConfigError(f"{where}: {text!r} is not a number")
    return value
