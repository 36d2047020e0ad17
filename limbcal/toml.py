"""TOML from anybody: read whole or refused with one sentence, whatever is in it."""

import tomllib
from pathlib import Path
from typing import Any

from limbcal.errors import ConfigError

#: Bytes of a file; the largest arm file that a calibration writes, with its covariances, has a hundredth of it.
MAX_BYTES = 8 * 1024 * 1024
#: Tables and lists within each other: an arm file needs four.
MAX_DEPTH = 16
#: What TOML calls an integer has 64 bits; beyond, Python's would grow without end.
_INTEGERS = range(-(1 << 63), 1 << 63)


def read_toml_text(path: Path) -> str:
    """Return the text of a TOML file.

    Raises
    ------
    OSError
        If it cannot be read.
    ConfigError
        If it is too long, or no UTF-8 text.
    """
    with path.open("rb") as file:
        content = file.read(MAX_BYTES + 1)  # a device file may have no end
    if len(content) > MAX_BYTES:
        raise ConfigError(f"{path}: not TOML: more than {MAX_BYTES} bytes, expected a file of some thousand")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: not TOML: {error}, expected UTF-8 text") from error


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """Return the tables of a TOML text, of plain values in bounds.

    Parameters
    ----------
    text : str
    where : str
        What it is the text of, for the sentence.

    Raises
    ------
    ConfigError
        If it is no TOML, nested too deep, too long, or holds a NUL or an integer of more than 64 bits.
    """
    if len(text) > MAX_BYTES:
        raise ConfigError(f"{where}: not TOML: {len(text)} characters, expected at most {MAX_BYTES}")
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{where}: not TOML: {error}") from error
    except RecursionError as error:
        raise ConfigError(f"{where}: not TOML: nested too deep, expected at most {MAX_DEPTH} levels") from error
    except ValueError as error:  # an integer of more digits than Python turns into a number
        said = "an integer of too many digits, expected at most 64 bits"
        raise ConfigError(f"{where}: not TOML: {said}") from error
    if mistake := _mistake_in(tables):
        raise ConfigError(f"{where}: not TOML: {mistake}")
    return tables


def _mistake_in(tables: dict[str, Any]) -> str | None:
    """Say what is out of bounds; by a list and not by recursion, which dotted keys would exhaust."""
    waiting: list[tuple[object, int]] = [(tables, 1)]
    while waiting:
        value, depth = waiting.pop()
        if depth > MAX_DEPTH:
            return f"nested too deep, expected at most {MAX_DEPTH} levels"
        if isinstance(value, dict):
            waiting += [(one, depth + 1) for pair in value.items() for one in pair]
        elif isinstance(value, list):
            waiting += [(one, depth + 1) for one in value]
        elif isinstance(value, str) and "\0" in value:
            return f"a NUL character in {value[:20]!r}, expected text"
        elif isinstance(value, int) and value not in _INTEGERS:
            return "an integer beyond 64 bits, expected a smaller number"
    return None
