"""TRC: a table of marker positions with tabs, as OpenSim and many laboratories write it; spreadsheets make commas.

Motion Analysis' programs write the points that they could not name behind the named ones, from frame to frame
others in the same columns.
"""

from pathlib import Path

import numpy as np

from limbcal.errors import DataError
from protocol.markers.recording import RawRecording
from protocol.markers.text_table import number_of, text_of

#: Lines before the first frame: type, names and values of the header, labels, axes; then an empty one, if any.
_HEADER_LINES = 5
#: A longer file is none of markers [byte]: hours of a hundred of them fit.
LARGEST_BYTES = 2_000_000_000


def read_trc(path: Path) -> RawRecording:
    """Read a TRC file.

    Raises
    ------
    DataError
        If it is none, or its frames do not fit its labels.
    """
    if path.stat().st_size > LARGEST_BYTES:
        raise DataError(f"{path}: it has {path.stat().st_size} bytes, expected at most {LARGEST_BYTES}")
    text = text_of(path)
    lines = text.splitlines()
    if len(lines) <= _HEADER_LINES or not lines[0].startswith("PathFileType"):
        raise DataError(f"{path}: its first line does not begin with PathFileType, expected a TRC file")
    by = "\t" if "\t" in lines[3] else ","
    header = _header(lines[1], lines[2])
    rate_hz = _number(path, header, "DataRate")
    labels = tuple(label.strip() for label in lines[3].split(by)[2:] if label.strip())
    rows = [line for line in lines[_HEADER_LINES:] if line.strip(" \t,")]
    stated = _stated_frames(header)
    if stated is not None and len(rows) < stated and not text.endswith("\n"):
        rows = rows[:-1]  # cut off within its last line
    table, unnamed = np.full((len(rows), 2 + 3 * len(labels)), np.nan), 0
    for k, row in enumerate(rows):
        fields = row.split(by)
        # A row may end with tabs, and one of them may stand double where the header has none.
        for i, text in enumerate(fields[: table.shape[1]]):
            if text.strip():
                table[k, i] = _value(path, text, k, i)
        more = _filled(fields[table.shape[1] :])
        if len(fields) < 2 or more % 3:
            expected = f"{table.shape[1]}, or three for each point without a name beside them"
            raise DataError(f"{path}: row {k + 1} has {len(fields)} fields, expected {expected}")
        unnamed = max(unnamed, more // 3)
    if not rows or not labels:
        raise DataError(f"{path}: it has {len(rows)} frames of {len(labels)} markers, expected some of each")
    points = table[:, 2:].reshape(len(rows), len(labels), 3)
    points[np.isnan(points).any(axis=2)] = np.nan
    return RawRecording(
        str(path),
        rate_hz,
        header.get("Units", ""),
        labels,
        points,
        table[:, 1],
        stated_frames=stated,
        unnamed=unnamed,
    )


def _filled(fields: list[str]) -> int:
    """Return the number of fields up to the last one that holds something."""
    return max((k + 1 for k, text in enumerate(fields) if text.strip()), default=0)


def _header(names: str, values: str) -> dict[str, str]:
    """Return the header's values by name; an empty one shifts no other where tabs or commas part them."""
    by = next((by for by in "\t," if by in names), None)
    return {name.strip(): value.strip() for name, value in zip(names.split(by), values.split(by), strict=False)}


def _stated_frames(header: dict[str, str]) -> int | None:
    text = header.get("NumFrames", "")
    return int(text) if text.isdecimal() else None


def _number(path: Path, header: dict[str, str], name: str) -> float:
    try:
        value = float(header[name])
    except (KeyError, ValueError):
        value = 0.0
    if not 0.0 < value < np.inf:
        raise DataError(f"{path}: {name} is {header.get(name)!r}, expected a number above 0")
    return value


def _value(path: Path, text: str, row: int, column: int) -> float:
    try:
        return number_of(text)
    except ValueError:
        raise DataError(f"{path}: row {row + 1}, field {column + 1} is {text!r}, expected a number") from None
