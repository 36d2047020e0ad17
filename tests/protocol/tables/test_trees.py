"""Whole files as trees."""

import json
import struct
import zlib

import numpy as np
import pytest
import scipy.io

from limbcal.errors import DataError
from protocol.tables.trees import _unpacked_bytes, fields_of, fields_within, load_tree


def test_variables_of_matlab_are_read_when_they_are_asked_for(tmp_path, monkeypatch):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"t": np.arange(3.0), "log": {"q": np.arange(3.0)}, "huge": np.zeros((100, 100))})
    asked = []
    load = scipy.io.loadmat
    monkeypatch.setattr(
        "scipy.io.loadmat", lambda *a, **more: asked.append(more["variable_names"]) or load(*a, **more)
    )
    root, notes = load_tree(path)
    assert not asked and not notes and set(fields_of(root)) == {"t", "log", "huge"}
    assert list(fields_within(root, "log")) == ["q"] and not fields_within(root, "huge")
    assert root["t"].ravel().tolist() == [0.0, 1.0, 2.0]
    assert asked == [["log"], ["t"]]


def test_a_json_of_lines_needs_no_other_suffix(tmp_path):
    path = tmp_path / "run.json"
    path.write_text("\n".join(json.dumps({"t": k}) for k in range(3)))
    root, notes = load_tree(path)
    assert [record["t"].item() for record in root] == [0, 1, 2] and not notes


@pytest.mark.parametrize("content", ["[1, 2]", "3", '{"t": [1, 2}'])
def test_what_is_no_table_is_said(tmp_path, content):
    path = tmp_path / "run.json"
    path.write_text(content)
    with pytest.raises(DataError, match=r"run\.json: cannot be read as \.json"):
        load_tree(path)


def lines_of(tmp_path, text, name="run.jsonl"):
    path = tmp_path / name
    path.write_text(text)
    return load_tree(path)


def test_a_last_line_that_is_cut_is_left_out_and_said(tmp_path):
    root, (note,) = lines_of(tmp_path, '{"t": 0}\n\n{"t": 1}\n{"t": 2, "q')
    assert [record["t"].item() for record in root] == [0, 1]
    assert note.text == "line 4, the last one, is cut off; it was left out, the rest was used"
    assert (note.kind, note.row) == ("cut", 4)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"t": 0}\n{"t": 1, "q\n{"t": 2}', "line 2: .*, expected an object a line"),
        ('{"t": 0}\n{"t": 1, "q\n', "line 2: .*, expected an object a line"),  # it has an end, so it is no cut
        ('{"t": 0, "q', "line 1: .*, expected an object a line"),
        ('{"t": 0}\n[1, 2]\n', r"line 2 holds '\[1, 2\]', expected an object with names"),
    ],
)
def test_a_line_that_is_no_object_is_said_with_its_number(tmp_path, text, said):
    with pytest.raises(DataError, match=said):
        lines_of(tmp_path, text)


def test_rows_of_one_length_are_a_table_and_others_are_cells(tmp_path):
    root, _ = lines_of(tmp_path, '{"even": [[1, 2], [3, 4], [5, 6]], "odd": [[1], [2, 3]]}', "run.json")
    assert root["even"].tolist() == [[1, 2], [3, 4], [5, 6]]
    assert [cell.tolist() for cell in root["odd"]] == [[1], [2, 3]]


def test_fields_are_those_of_the_first_record(tmp_path):
    root, _ = lines_of(tmp_path, '{"runs": [{"q": [1, 2]}, {"q": [3], "more": 4}], "none": []}', "run.json")
    assert list(fields_of(root["runs"])) == ["q"]
    assert fields_of(root["none"]) == {} and fields_of(root["runs"][0]["q"]) == {}


def test_a_matlab_scalar_is_one_and_an_array_keeps_its_shape(tmp_path):
    path = tmp_path / "run.mat"
    runs = np.array([(1.0, [[1.0, 2.0]]), (2.0, [[3.0]])], dtype=[("kp", object), ("q", object)])
    scipy.io.savemat(path, {"one": 5.0, "row": np.arange(4.0), "table": np.ones((2, 3)), "runs": runs})
    root, _ = load_tree(path)
    assert (root["one"].shape, root["row"].shape, root["table"].shape) == ((), (1, 4), (2, 3))
    assert [record["kp"].item() for record in root["runs"]] == [1.0, 2.0]
    assert [record["q"].ravel().tolist() for record in root["runs"]] == [[1.0, 2.0], [3.0]]


@pytest.mark.parametrize("packed", [False, True])
def test_how_much_a_matlab_file_unpacks_to_is_known_before(tmp_path, packed):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"a": np.zeros((1000, 10)), "b": np.ones(500)}, do_compression=packed)
    assert _unpacked_bytes(path) == pytest.approx(8 * 10_500, abs=200)
    scipy.io.savemat(path, {"a": np.zeros((1000, 10))}, format="4")
    assert _unpacked_bytes(path) == path.stat().st_size


def mat5(path, order, *elements):
    """Write a MATLAB file of version 5 by hand: each element has a type, and contents that may be packed."""
    out = bytes(126) + {"<": b"IM", ">": b"MI"}[order]
    for kind, content in elements:
        out += struct.pack(f"{order}II", kind, len(content)) + content
    path.write_bytes(out)
    return path


@pytest.mark.parametrize("order", ["<", ">"])
def test_the_length_of_what_is_packed_is_read_in_either_order_of_bytes(tmp_path, order):
    packed = zlib.compress(struct.pack(f"{order}II", 14, 70_000) + bytes(70_000))
    path = mat5(tmp_path / "run.mat", order, (14, bytes(40)), (15, packed), (14, bytes(8)))
    assert _unpacked_bytes(path) == 40 + 70_000 + 8
    assert _unpacked_bytes(mat5(path, order)) == 0
    assert _unpacked_bytes(mat5(path, order, (15, zlib.compress(b"short")))) == 0
    path.write_bytes(path.read_bytes() + bytes(7))  # less than a type and a length
    assert _unpacked_bytes(path) == 0


@pytest.mark.parametrize("before", [0, 512])
@pytest.mark.parametrize("name", ["run.mat", "RUN.MAT"])
def test_a_file_of_matlab_7_3_is_told_by_its_signature(tmp_path, before, name):
    path = tmp_path / name
    path.write_bytes(bytes(before) + b"\x89HDF\r\n\x1a\n" + bytes(100))
    with pytest.raises(DataError, match=r"a MATLAB 7.3 file, expected one saved in MATLAB with save\(…, '-v7'\)"):
        load_tree(path)


def test_a_file_that_is_not_there_is_said(tmp_path):
    with pytest.raises(DataError, match="there is no such file"):
        load_tree(tmp_path / "none.mat")


def test_a_variable_that_is_damaged_is_named(tmp_path):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"good": np.arange(3.0), "bad": np.arange(300.0)}, do_compression=True)
    root, _ = load_tree(path)
    data = bytearray(path.read_bytes())
    data[-20:] = bytes(20)
    path.write_bytes(bytes(data))
    assert root["good"].ravel().tolist() == [0.0, 1.0, 2.0]
    with pytest.raises(DataError, match=r"run\.mat: 'bad' cannot be read \("):
        root["bad"]
    assert "bad" in root and "ugly" not in root and len(root) == 2
    with pytest.raises(KeyError):
        root["ugly"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"columns": ["t", 1], "data": [[0, 5], [1, 6]]}', {"t": [0, 1], "1": [5, 6]}),
        ('{"t": {"0": 0, "1": 1}, "q": {"0": 5, "1": 6}}', {"t": [0, 1], "q": [5, 6]}),
        ('{"columns": [0, 1], "data": [2, 3]}', {"columns": [0, 1], "data": [2, 3]}),
        ('{"columns": 3, "data": [2, 3]}', {"columns": 3, "data": [2, 3]}),
        ('{"name": ["a", "b"], "mixed": [1, "b", null], "yes": [true, 0]}',
         {"name": ["a", "b"], "mixed": [1, "b", None], "yes": [1, 0]}),
    ],
)  # fmt: skip
def test_tables_that_pandas_wrote_are_columns(tmp_path, text, expected):
    root, _ = lines_of(tmp_path, text, "run.json")
    assert {name: column.tolist() for name, column in root.items()} == expected


def test_names_of_only_some_rows_are_no_table_of_pandas(tmp_path):
    root, _ = lines_of(tmp_path, '{"t": {"0": 0}, "log": {"q": 1}}', "run.json")
    assert fields_of(root["t"])["0"].item() == 0 and list(fields_of(root["log"])) == ["q"]


@pytest.mark.parametrize(
    ("cells", "kind"),
    [("[1, 2.5]", "f"), ("[1, 2]", "i"), ('["a", "bc"]', "U"), ('[1, "a"]', "O"), ("[null]", "O")],
)
def test_a_row_is_of_what_all_its_cells_are(tmp_path, cells, kind):
    root, _ = lines_of(tmp_path, f'{{"x": {cells}}}', "run.json")
    assert root["x"].dtype.kind == kind
