"""Cells of nested files beside columns that have none."""

import json

import pytest

from limbcal.errors import DataError
from protocol.tables.files import open_source
from protocol.tables.nested import NestedFile
from protocol.tables.source import Column


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "run.json"
    cells = [{"q": [1.0, 2.0]}, {"q": [3.0, 4.0]}, {"q": [5.0, 6.0]}]
    path.write_text(json.dumps({"t": [0.0, 1.0], "runs": cells, "two": cells[:2], "one": cells[:1]}))
    found = open_source(path)
    assert isinstance(found, NestedFile)
    return found


@pytest.mark.parametrize("time", ["t", "one.q"])
def test_one_row_serves_every_cell_beside_it(source, time):
    found = source.read({"t": [Column(time)], "q": [Column("runs.q")]}, None)
    assert [rows.groups["q"][:, 0].tolist() for rows in found] == [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
    assert [rows.groups["t"][:, 0].tolist() for rows in found] == [[0.0, 1.0] if time == "t" else [1.0, 2.0]] * 3


def test_cells_of_different_numbers_are_refused(source):
    with pytest.raises(DataError, match="the cell arrays hold runs.q 3, two.q 2 cells, expected the same number"):
        source.read({"q": [Column("runs.q"), Column("two.q")]}, None)
