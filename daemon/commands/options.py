"""Options that several commands have, and the numbers that they take."""

import argparse
import math
from pathlib import Path

DEFAULT_ENDPOINT = "tcp://127.0.0.1:5770"

_FLAGS = {
    "port": ("device", "port"),
    "baud": ("device", "baud"),
    "arm": ("arm", "file"),
    "method": ("tracking", "method"),
    "endpoint": ("publish", "endpoint"),
    "record": ("record", "directory"),
}


def add_device_options(parser: argparse.ArgumentParser) -> None:
    """Add what says where samples come from."""
    parser.add_argument("--config", type=Path, metavar="FILE", help="limbd.toml; flags win over it")
    parser.add_argument("--port", metavar="P", help="serial port of the device")
    parser.add_argument("--baud", type=int, metavar="B", help="baud rate (default 12000000)")
    parser.add_argument("--arm", metavar="A", help="arm file or the name of a built-in arm")


def given(arguments: argparse.Namespace) -> dict[str, dict[str, object]]:
    """Return the flags that were given, as the config's tables."""
    tables: dict[str, dict[str, object]] = {}
    for flag, (table, key) in _FLAGS.items():
        value = getattr(arguments, flag, None)
        if value is not None:
            tables.setdefault(table, {})[key] = value
    return tables


def positive(text: str) -> float:
    """Return a number above 0."""
    value = not_negative(text)
    if value == 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return value


def not_negative(text: str) -> float:
    """Return a number of at least 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of at least 0")
    return value


def whole(text: str) -> int:
    """Return a whole number of at least 0."""
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least 0")
    return int(text)
