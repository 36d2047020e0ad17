"""The end of a text file of columns: a last line that was cut, rows of nothing, zeros of a disk without power."""

import re
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa

from limbcal.note import Note
from protocol.tables.dialect import BLANKS, HEAD_BYTES, Dialect

#: Number of rows before a cut number in which it was longer; by chance at most 1 of 64 files has one.
_CUT_WITNESSES = 64
_LINE_END = re.compile(rb"\r\n|\n|\r")


def last_row_end(content: pa.Buffer, dialect: Dialect, path: Path) -> tuple[int, tuple[Note, ...]]:
    """Return where the last whole row of a file ends [byte], and what there is to say about what follows.

    Parameters
    ----------
    content : pyarrow.Buffer
        All of the file.
    dialect : Dialect
    path : Path
        For the notes.
    """
    begin = max(dialect.start, content.size - HEAD_BYTES)
    tail = content[begin : content.size].to_pybytes().rstrip(b"\0")
    complete = tail.endswith((b"\n", b"\r"))
    body = tail.rstrip(b"\r\n\t " if dialect.delimiter == BLANKS else b"\r\n\t ,;|")
    last = max(body.rfind(b"\n"), body.rfind(b"\r")) + 1
    line_end = _LINE_END.search(tail, last)
    stop = begin + (len(tail) if line_end is None else line_end.end())
    if complete or last == 0:
        return stop, ()
    rows = body[:last].splitlines()
    cut, before = _cells(tail[last:], dialect), _cells(rows[-1], dialect)
    if not _is_whole(cut, before, dialect):
        text = f"the last line is cut off ({len(cut)} of {len(before)} cells)"
    elif _ends_early(cut, rows[-_CUT_WITNESSES:], dialect):
        text = "the last line ends within a number and has no end of line"
    else:
        return stop, ()
    return begin + last, (Note("cut", f"{text}; it was left out, the rest was used", source=str(path)),)


def _is_whole(row: Sequence[str], before: Sequence[str], dialect: Dialect) -> bool:
    """Say whether a row has a value wherever the one before it has."""
    return len(row) >= len(before) and all(
        dialect.is_value(cell) or not dialect.is_value(other) for cell, other in zip(row, before, strict=False)
    )


def _ends_early(row: Sequence[str], rows: Sequence[bytes], dialect: Dialect) -> bool:
    """Say whether the last number of a row is shorter than that of any of many rows before it."""
    if len(rows) < _CUT_WITNESSES:
        return False
    return len(row[-1]) < min(len(cells[-1]) for cells in (_cells(line, dialect) for line in rows) if cells)


def _cells(line: bytes, dialect: Dialect) -> list[str]:
    return dialect.cells(line.decode(dialect.encoding, errors="replace"))
