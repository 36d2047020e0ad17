"""One table, written in any way and read back."""

from pathlib import Path

import numpy as np

from protocol.tables.columns import parse_mapping
from protocol.tables.reader import read_table_blocks, read_tables

N = 40


T = 0.01 * np.arange(N)


Q = np.column_stack([np.sin(T), 1.0 - T])


def read(path, columns=None, n_joint=2, **more):
    """Read a file whole and in blocks, which must agree; return it whole."""
    mapping = parse_mapping(columns, n_joint)
    (table,) = read_tables(path, n_joint, mapping, ("q",), **more)
    blocks = list(read_table_blocks(path, n_joint, mapping, ("q",), more.get("rate_hz"), 16))
    for role, values in table.groups.items():
        assert np.array_equal(np.concatenate([block.groups[role] for block in blocks]), values), role
    assert blocks[0].notes == table.notes and blocks[0].stated == table.stated
    return table


def text_of(header, *, sep=",", decimal=".", end="\n", first="", comment="", trail=""):
    """Return the motion as text under a header."""
    rows = [
        sep.join(f"{value:.6f}".replace(".", decimal) for value in (t, *q)) + trail
        for t, q in zip(T, Q, strict=True)
    ]
    return first + comment + header + end + end.join(rows) + end


def written(tmp_path: Path, content, name="run.csv") -> Path:
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path
