"""How a text file of columns is written: its encoding, its header, what parts its cells, where its rows begin."""

import codecs
import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from limbcal.errors import DataError
from protocol.tables.units import is_no_unit, parse_unit

COMMENTS = ("//", "#", "%")
#: What parts words where nothing else parts cells: one or more of them.
BLANKS = " "
#: Tried in this order: in a file with semicolons a comma is a decimal sign.
_DELIMITERS = ("\t", ";", ",", "|")
#: Lines of text that may stand before the header without a remark's sign.
_LONGEST_PREAMBLE = 64
#: So much of a file is looked at [bytes].
HEAD_BYTES = 1 << 18
#: Number of rows in which all cells of a line must agree with the header.
_WITNESSES = 8
_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)
_COMMA_NUMBER = re.compile(r"\s*[-+]?\d*,\d+(?:[eE][-+]?\d+)?\s*")
_POINT_NUMBER = re.compile(r"\s*[-+]?\d*\.\d+(?:[eE][-+]?\d+)?\s*")
_STAMP = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:[.,]\d+)?)?\s*(?:Z|[-+]\d\d:?\d\d)?")


@dataclass(frozen=True)
class Dialect:
    """How a file is written.

    Attributes
    ----------
    encoding : str
        Of the bytes; in every one that is named here a comma and a digit are one byte each.
    delimiter, decimal : str
        What parts cells, `BLANKS` for any number of blanks; and the decimal sign.
    names : tuple of str
        One a cell of a row, empty where a column has no name.
    units : dict of str to str
        What stands below names in a row of units.
    start : int
        Where the first row begins [byte].
    sample : tuple of tuple of str
        Cells of the first rows.
    preamble : int
        Lines before the header that are neither remarks nor rows.
    """

    encoding: str
    delimiter: str
    decimal: str
    names: tuple[str, ...]
    units: dict[str, str]
    start: int
    sample: tuple[tuple[str, ...], ...]
    preamble: int = 0

    def cells(self, line: str) -> list[str]:
        """Return the cells of a line."""
        return split_cells(line, self.delimiter)

    def is_value(self, cell: str) -> bool:
        """Say whether a cell holds a number or a time stamp."""
        return is_value(cell, self.decimal)


def encoding_of(head: bytes) -> str:
    """Return the encoding of the text that begins with some bytes."""
    head = head.rstrip(b"\0")  # a disk that lost power leaves zeros
    if head.startswith(codecs.BOM_UTF8):
        return "utf-8-sig"
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    for encoding, zeros in (("utf-16-le", head[1::2]), ("utf-16-be", head[::2])):
        if head and zeros.count(0) > 0.4 * len(head) / 2:  # in Latin script nearly every other byte is 0
            return encoding
    for encoding in ("utf-8", "cp1252"):
        try:
            codecs.getincrementaldecoder(encoding)().decode(head)
        except UnicodeDecodeError:
            continue
        return encoding
    return "latin-1"


def dialect_of(head: bytes, encoding: str, path: Path) -> Dialect:
    """Find out how a file is written.

    Parameters
    ----------
    head : bytes
        Its beginning, in an encoding that has ASCII in it.
    encoding : str
    path : Path
        For errors.

    Raises
    ------
    DataError
        If there is no header, or nothing at all.
    """
    head = head.rstrip(b"\0")
    if b"\0" in head:
        raise DataError(f"{path}: cannot be read as CSV (it is no text), expected a header row and numbers")
    lines = _lines(head, encoding)
    delimiter = None
    if lines and (said := _SEPARATOR.fullmatch(lines[0][1].strip(" \r\n"))):
        delimiter, lines = said[1], lines[1:]
    filled = [(offset, text) for offset, text in lines if text.strip()]
    content = [(offset, text) for offset, text in filled if not text.lstrip().startswith(COMMENTS)]
    if not content:
        raise DataError(f"{path}: the file is empty, expected a header row and numbers")
    remarks = [text for offset, text in filled if offset < content[0][0]]
    units: dict[str, str] = {}
    preamble = 0
    commented = _commented_header(remarks, [text for _, text in content[: 1 + _WITNESSES]], delimiter)
    if commented is not None:
        header, units, delimiter = commented
    else:
        preamble, delimiter = _header_line([text for _, text in content], delimiter)
        (offset, text), content = content[preamble], content[preamble + 1 :]
        header = [cell.strip("'") for cell in split_cells(text, delimiter)]
        if all(is_value(cell, "") for cell in header if cell) and any(header):
            raise DataError(f"{path}: the first row is {text.strip()!r}, expected names of columns")
        below = [remark for place, remark in filled if place > offset and (not content or place < content[0][0])]
        units = _units_in(header, [split_cells(_without_sign(remark), delimiter) for remark in below])
    if content and _is_units(split_cells(content[0][1], delimiter)):
        units = _units_in(header, [split_cells(content[0][1], delimiter)])
        content = content[1:]
    sample = tuple(tuple(split_cells(text, delimiter)) for _, text in content)
    flat = [cell for row in sample for cell in row]
    commas = any(map(_COMMA_NUMBER.fullmatch, flat)) and not any(map(_POINT_NUMBER.fullmatch, flat))
    start = content[0][0] if content else len(head)
    names = _fitted(header, sample[0]) if sample else header
    return Dialect(encoding, delimiter, "," if commas else ".", tuple(names), units, start, sample, preamble)


def split_cells(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line without blanks and quotes around them."""
    if delimiter == BLANKS:
        return line.split()
    try:
        (cells,) = csv.reader([line.strip("\r\n")], delimiter=delimiter, skipinitialspace=True)
    except (csv.Error, ValueError):
        cells = line.split(delimiter)
    return [cell.strip() for cell in cells]


def is_stamp(cell: str) -> bool:
    """Say whether a cell holds a date and a time as ISO 8601 has them."""
    return _STAMP.fullmatch(cell.strip()) is not None


def is_value(cell: str, decimal: str) -> bool:
    """Say whether a cell holds a number or a time stamp; any decimal sign will do where none is named."""
    try:
        float(cell.replace(",", ".") if decimal != "." else cell)
    except ValueError:
        return is_stamp(cell)
    return True


def _lines(head: bytes, encoding: str) -> list[tuple[int, str]]:
    """Return the lines of a head, each with where it begins; without a last one that may go on."""
    found: list[tuple[int, str]] = []
    offset = len(codecs.BOM_UTF8) if encoding == "utf-8-sig" else 0
    for line in head[offset:].splitlines(keepends=True):
        text = line.decode(encoding, errors="replace")
        if len(found) == 1 and found[0][1].count('"') % 2:
            begin, name = found.pop()  # a name with a line's end in it, as spreadsheets have
            found.append((begin, name + text))
        else:
            found.append((offset, text))
        offset += len(line)
    return found[:-1] if len(head) >= HEAD_BYTES else found


def _header_line(lines: Sequence[str], delimiter: str | None) -> tuple[int, str]:
    """Return the first line whose cells are names of the values below it, and what parts them.

    Where there is none, it is the first line.
    """
    tried = (delimiter,) if delimiter else (*_DELIMITERS, BLANKS)
    for k, line in enumerate(lines[:_LONGEST_PREAMBLE]):
        for candidate in tried:
            cells = split_cells(line, candidate)
            rows = [split_cells(row, candidate) for row in lines[k + 1 : k + 2 + _WITNESSES]]
            judged = rows[:-1] or rows  # the last one may be cut
            fits = len(cells) > 1 and judged and all(_compatible(cells, row) for row in judged)
            if fits and (k == 0 or _names_values(cells, judged)):
                return k, candidate
    return 0, delimiter or max(",;\t|", key=lambda part: len(split_cells(lines[0], part)))


def _names_values(cells: Sequence[str], rows: Sequence[Sequence[str]]) -> bool:
    """Say whether cells are names and most of what stands below them is numbers."""
    below = [cell for row in rows[-2:] for cell in row if cell]
    named = not any(is_value(cell, "") for cell in cells if cell)
    return len(rows) > 1 and named and sum(is_value(cell, "") for cell in below) > 0.5 * len(below)


def _compatible(header: Sequence[str], row: Sequence[str]) -> bool:
    """Say whether a row has as many cells as the header, but for empty ones at the end."""
    shorter = min(len(header), len(row))
    return not any(header[shorter:]) and not any(row[shorter:])


def _commented_header(
    remarks: Sequence[str], rows: Sequence[str], delimiter: str | None
) -> tuple[list[str], dict[str, str], str] | None:
    """Return the header that the last remark is, as `numpy.savetxt` and MATLAB write it, units, what parts cells.

    A remark of units may stand below it.
    """
    for candidate in (delimiter,) if delimiter else (*_DELIMITERS, BLANKS):
        cells = [split_cells(row, candidate) for row in rows]
        if not any(is_value(cell, "") for cell in cells[0]):
            continue  # names: the first row is the header itself
        for parting in (*_DELIMITERS, BLANKS) if candidate == BLANKS else (candidate, *_DELIMITERS, BLANKS):
            last = [split_cells(_without_sign(remark), parting) for remark in remarks[-2:]]
            below = last[1:] if len(last) == 2 and _is_units(last[1]) and len(last[0]) == len(last[1]) else []
            names = last[0] if below else last[-1] if last else []
            named = all(names) and not any(is_value(name, "") for name in names)
            if named and len(names) == len(cells[0]) and (len(names) > 1 or all(len(row) == 1 for row in cells)):
                return names, _units_in(names, below), candidate
    return None


def _without_sign(remark: str) -> str:
    return remark.strip().lstrip("#%/ \t")


def _units_in(header: Sequence[str], rows: Sequence[Sequence[str]]) -> dict[str, str]:
    """Return the units below the names of a header, if one of the rows holds them."""
    for row in rows:
        if len(row) <= len(header) and _is_units(row):
            return {name: cell for name, cell in zip(header, row, strict=False) if not is_no_unit(cell)}
    return {}


def _is_units(cells: Sequence[str]) -> bool:
    """Say whether a row holds units: one at least that is known, and nothing but units."""
    if any(is_value(cell, "") for cell in cells if not is_no_unit(cell)) or all(map(is_no_unit, cells)):
        return False
    filled = [cell for cell in cells if not is_no_unit(cell)]
    known = [parse_unit(cell) is not None for cell in filled]
    bracketed = [re.fullmatch(r"\[.*\]|\(.*\)", cell) is not None for cell in filled]
    return any(known) and sum(map(any, zip(known, bracketed, strict=True))) >= len(filled) / 2


def _fitted(header: Sequence[str], row: Sequence[str]) -> list[str]:
    """Give the header as many cells as a row has, if it only lacks or has empty ones."""
    if not _compatible(header, row):
        return list(header)
    return [*header[: len(row)], *[""] * (len(row) - len(header))]
