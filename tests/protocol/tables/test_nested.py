"""Arrays within names: MATLAB and JSON."""

import json

import numpy as np
import pytest
import scipy.io

from limbcal.errors import DataError
from protocol.tables.clock import Clock
from protocol.tables.columns import parse_mapping
from protocol.tables.files import open_source
from protocol.tables.nested import NestedFile
from protocol.tables.reader import read_tables
from protocol.tables.source import Column


def read(path, *addresses):
    columns = [Column(address) for address in addresses]
    return [table.groups["x"] for table in open_source(path).read({"x": columns}, None)]


@pytest.fixture
def mat(tmp_path):
    """Cells of two motions, a struct, a table, as MATLAB would save them."""
    path = tmp_path / "run.mat"
    cells = np.empty((2, 1), dtype=object)
    cells[0, 0] = np.arange(20.0).reshape(4, 5)
    cells[1, 0] = 100.0 + np.arange(24.0).reshape(4, 6)
    stamps = np.empty((2, 1), dtype=object)
    stamps[0, 0], stamps[1, 0] = np.arange(5.0)[:, None], np.arange(6.0)[:, None]
    log = {"time": np.arange(3.0)[:, None], "angles": np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]), "dt": 0.5}
    scipy.io.savemat(path, {"Y": cells, "T": stamps, "log": log, "name": "a run"})
    return path


def test_cells_are_motions(mat):
    first, second = read(mat, "T", "Y[1]", "Y[4]")
    assert first[:, 1].tolist() == [0, 1, 2, 3, 4]
    assert first[:, 2].tolist() == [15, 16, 17, 18, 19]
    assert second.shape == (6, 3)


def test_one_cell_can_be_picked(mat):
    (only,) = read(mat, "T(2)", "Y(2)[1]")
    assert only[:, 1].tolist() == [100, 101, 102, 103, 104, 105]


def test_fields_of_a_struct(mat):
    (table,) = read(mat, "log.time", "log.angles[2]")
    assert table[:, 1].tolist() == [2, 4, 6]
    assert set(NestedFile(mat).names) >= {"Y", "T", "log.time", "log.angles"}


@pytest.mark.parametrize(
    ("addresses", "said"),
    [
        (["log.velocity"], "no 'velocity', expected one of time, angles, dt"),
        (["Y[5]"], "[5] of a table with 4 rows, expected 1 to 4"),
        (["Y[0]"], "expected 1 to 4"),
        (["Y[x]"], "'x' is no index"),
        (["Y(3)[1]"], "(3) of something with 2 cells"),
        (["log(1)"], "no cells"),
        (["log"], "expected an array"),
        (["log.angles"], "has shape (3, 2)"),
        (["log.dt"], "has shape ()"),
        (["name"], "expected"),
        (["Y[1]{2}"], "cannot read '{2}'"),
        (["log.time", "T(1)"], "lengths log.time 3, T(1) 5"),
        (["[1]"], "name of an array first"),
    ],
)
def test_an_address_that_leads_nowhere(mat, addresses, said):
    with pytest.raises(DataError) as caught:
        read(mat, *addresses)
    assert said in str(caught.value)
    assert str(mat) in str(caught.value)


def test_arrays_with_other_numbers_of_cells(mat, tmp_path):
    three = np.empty((1, 3), dtype=object)
    for k in range(3):
        three[0, k] = np.arange(5.0)
    scipy.io.savemat(mat, {"A": three, **{k: v for k, v in scipy.io.loadmat(mat).items() if k == "T"}})
    with pytest.raises(DataError, match="A 3, T 2 cells"):
        read(mat, "A", "T")


def test_records_become_columns(tmp_path):
    path = tmp_path / "run.json"
    entries = [{"at": k / 10, "q": [k, -k], "on": True} for k in range(4)]
    path.write_text(json.dumps({"mass": 0.5, "entries": entries, "table": [[1, 2, 3], [4, 5, 6]]}))
    (table,) = read(path, "entries.at", "entries.on")
    assert table.tolist() == [[0.0, 1.0], [0.1, 1.0], [0.2, 1.0], [0.3, 1.0]]
    assert read(path, "table[2]")[0][:, 0].tolist() == [4, 5, 6]
    assert "entries.at" in NestedFile(path).names


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "cannot be read as .json"),
        ("{", "cannot be read as .json"),
        ("[1, 2]", "bare list"),
        ('{"a": [1, null, 3]}', "a, row 2: found nothing or NaN"),
        ('{"a": [1, "two", 3]}', "expected numbers"),
        ('{"a": [{"b": 1}, {"c": 1}]}', "record 2 has no 'b'"),
        ('{"a": {"b": [1, 2]}}', "there is no 'b'"),
    ],
)
def test_json_that_does_not_fit(tmp_path, content, said):
    path = tmp_path / "run.json"
    path.write_text(content)
    address = "a.b" if '"b": 1' in content else "a.b.b" if "{" in content[4:] else "a"
    with pytest.raises(DataError) as caught:
        read(path, address)
    assert said in str(caught.value)


@pytest.mark.parametrize("name", ["run.mat"])
@pytest.mark.parametrize("content", [b"", b"no such thing at all"])
def test_files_that_are_something_else(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(DataError, match=name):
        NestedFile(path)


def test_cells_can_be_joined_or_some_be_picked(mat):
    (whole,) = read(mat, "T(join)", "Y(join)[1]")
    assert whole[:, 1].tolist() == [0, 1, 2, 3, 4, 100, 101, 102, 103, 104, 105]
    (last,) = read(mat, "Y(join 2:2)[2]")
    assert last[:, 0].tolist() == [106, 107, 108, 109, 110, 111]
    assert [len(one) for one in read(mat, "Y(:)[1]")] == [5, 6]
    assert [len(one) for one in read(mat, "Y(2:)[1]")] == [6]
    with pytest.raises(DataError, match=r"\(2:3\) of something with 2 cells"):
        read(mat, "Y(2:3)[1]")
    with pytest.raises(DataError, match="no cells"):
        read(mat, "log.angles(join)")


def drive_of(path, n_joint, columns):
    """Return the gains of every motion of a file."""
    mapping = parse_mapping(columns, n_joint)
    return [table.groups["kp"] for table in read_tables(path, n_joint, mapping, ("q",))]


def test_a_gain_may_be_one_number_of_the_file(tmp_path):
    path = tmp_path / "servo.json"
    entries = [{"time": 0.01 * k, "angle": 0.1 * k, "enabled": k < 5} for k in range(8)]
    path.write_text(json.dumps({"kp": 400, "gains": [1.5, 2.5], "entries": entries}))
    (kp,) = drive_of(path, 1, "t=entries.time,q=entries.angle,on=entries.enabled,kp=kp/800")
    assert kp.tolist() == [[0.5]] * 8
    (kp,) = drive_of(path, 2, "t=entries.time,q=entries.angle*{j},kp=gains[{j}]")
    assert kp.tolist() == [[1.5, 2.5]] * 8
    with pytest.raises(DataError, match="expected a row of numbers"):
        read_tables(path, 1, parse_mapping("t=entries.time,q=kp", 1), ("q",))


def test_every_motion_may_have_a_gain_of_its_own(tmp_path):
    path = tmp_path / "runs.json"
    runs = [{"t": [0, 1, 2], "q": [0, 1, 2], "kp": 3}, {"t": [0, 1], "q": [5, 6], "kp": 4}]
    path.write_text(json.dumps({"runs": runs}))
    first, second = drive_of(path, 1, "t=runs.t,q=runs.q,kp=runs.kp")
    assert first.tolist() == [[3]] * 3 and second.tolist() == [[4]] * 2


def test_gains_of_all_joints_in_one_row_of_a_mat(tmp_path):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"t": np.arange(4.0), "q": np.ones((4, 2)), "kp": [[9.5, 2.0]]})
    (kp,) = drive_of(path, 2, "q=q[{j}],kp=kp[{j}]")
    assert kp.tolist() == [[9.5, 2.0]] * 4


def test_a_column_of_nulls_alone_is_blank(tmp_path):
    path = tmp_path / "run.json"
    rows = [{"t": 0.1 * k, "q": None, "tau": None if k else 1.0, "on": "yes"} for k in range(4)]
    path.write_text(json.dumps(rows), encoding="utf-8")
    source = open_source(path)
    assert isinstance(source, NestedFile)
    assert [source.is_blank(name) for name in ("t", "q", "tau", "on", "nowhere")] == [
        False,
        True,
        False,
        False,
        False,
    ]


def nested(root, tmp_path):
    path = tmp_path / "data.json"
    path.write_text(json.dumps(root))
    return NestedFile(path)


def column(file, address, **known):
    (rows,) = file.read({"x": [Column(address, **known)]}, None)
    return rows.groups["x"][:, 0].tolist()


def test_the_longer_side_of_a_table_is_time(tmp_path):
    wide, high = [[1, 2, 3, 4], [5, 6, 7, 8]], [[1, 5], [2, 6], [3, 7], [4, 8]]
    for table in (wide, high):
        assert column(nested({"a": table}, tmp_path), "a[2]") == [5, 6, 7, 8]
    square = [[1, 2], [3, 4]]
    assert column(nested({"a": square}, tmp_path), "a[1]") == [1, 3]  # rows are instants, as in a text


def test_a_table_of_one_row_is_a_row(tmp_path):
    assert column(nested({"a": [[1, 2, 3]]}, tmp_path), "a") == [1, 2, 3]
    assert column(nested({"a": [[1], [2], [3]]}, tmp_path), "a") == [1, 2, 3]
    assert column(nested({"a": [[1, 2, 3]]}, tmp_path), "a[1]") == [1, 2, 3]


@pytest.mark.parametrize(
    ("cells", "picked"),
    [
        ("(:)", [[1], [2, 3], [4, 5, 6]]),
        ("(2:)", [[2, 3], [4, 5, 6]]),
        ("(:2)", [[1], [2, 3]]),
        ("(2:2)", [[2, 3]]),
        ("( 1 : 3 )", [[1], [2, 3], [4, 5, 6]]),
        ("(join)", [[1, 2, 3, 4, 5, 6]]),
        ("(join 2:3)", [[2, 3, 4, 5, 6]]),
        ("(3)", [[4, 5, 6]]),
    ],
)
def test_cells_are_counted_from_one(tmp_path, cells, picked):
    file = nested({"a": [{"q": [1]}, {"q": [2, 3]}, {"q": [4, 5, 6]}]}, tmp_path)
    found = file.read({"x": [Column(f"a{cells}.q")]}, None)
    assert [rows.groups["x"][:, 0].tolist() for rows in found] == picked


@pytest.mark.parametrize("cells", ["(0:1)", "(3:2)", "(2:4)", "(0)", "(4)", "()", "(x)", "(-1)"])
def test_cells_that_are_not_there_are_said(tmp_path, cells):
    file = nested({"a": [{"q": [1]}, {"q": [2, 3]}, {"q": [4, 5, 6]}]}, tmp_path)
    with pytest.raises(DataError, match="data.json: a"):
        file.read({"x": [Column(f"a{cells}.q")]}, None)


def test_a_number_of_a_row_of_gains_is_of_every_row(tmp_path):
    file = nested({"t": [0, 1, 2], "kp": [7, 8], "one": 5}, tmp_path)
    (rows,) = file.read(
        {"t": [Column("t")], "kp": [Column("kp[2]", per_file=True), Column("one", per_file=True)]}, None
    )
    assert rows.groups["kp"].tolist() == [[8, 5]] * 3
    for k in (0, 3):
        with pytest.raises(DataError, match=rf"\[{k}\] of a row of 2 numbers, expected 1 to 2"):
            file.read({"kp": [Column(f"kp[{k}]", per_file=True)]}, None)
    with pytest.raises(DataError, match=r"\[1\] of something with shape \(2,\), expected a table"):
        file.read({"kp": [Column("kp[1]")]}, None)


def test_records_with_a_gain_each_are_motions_with_it(tmp_path):
    runs = [{"q": [1, 2], "kp": 5.0}, {"q": [3, 4, 5], "kp": 6.0}]
    file = nested({"runs": runs}, tmp_path)
    found = file.read({"q": [Column("runs.q")], "kp": [Column("runs.kp", per_file=True)]}, None)
    assert [rows.groups["kp"].tolist() for rows in found] == [[[5.0]] * 2, [[6.0]] * 3]


def test_labels_come_with_their_rows(tmp_path):
    file = nested({"q": [1, 2, 3], "trial": ["a", "a", "b"]}, tmp_path)
    (rows,) = file.read({"q": [Column("q")]}, "trial")
    assert rows.labels is not None and rows.labels.tolist() == ["a", "a", "b"]
    assert [one.groups["q"].tolist() for one in file.blocks({"q": [Column("q")]}, "trial", 1)] == [[[1], [2], [3]]]
    assert not file.streams({}, None)
    short = nested({"q": [1, 2, 3], "trial": ["a", "b"]}, tmp_path)
    with pytest.raises(DataError, match="the columns have lengths q 3, trial 2, expected one length"):
        short.read({"q": [Column("q")]}, "trial")


def test_one_clock_may_be_that_of_every_motion(tmp_path):
    file = nested({"t": [0.0, 0.5], "runs": [{"q": [1, 2]}, {"q": [3, 4]}]}, tmp_path)
    found = file.read({"t": [Column("t")], "q": [Column("runs.q")]}, None)
    assert [rows.groups["t"][:, 0].tolist() for rows in found] == [[0.0, 0.5]] * 2
    assert [rows.groups["q"][:, 0].tolist() for rows in found] == [[1, 2], [3, 4]]


def test_every_motion_has_labels_of_its_own(tmp_path):
    runs = [{"q": [1, 2], "who": ["a", "b"]}, {"q": [3, 4], "who": ["c", "d"]}]
    found = nested({"runs": runs}, tmp_path).read({"q": [Column("runs.q")]}, "runs.who")
    assert [rows.labels.tolist() for rows in found if rows.labels is not None] == [["a", "b"], ["c", "d"]]


def test_dates_are_no_numbers_where_no_time_is_asked_for(tmp_path):
    file = nested({"q": ["2024-05-01T12:00:00", "2024-05-01T12:00:01"]}, tmp_path)
    with pytest.raises(DataError, match="data.json: q.*expected numbers"):
        column(file, "q")


def test_a_null_is_a_number_that_is_missing(tmp_path):
    file = nested({"runs": [{"q": 1.0}, {"q": None}, {"q": 3.0}]}, tmp_path)
    assert not file.is_blank("runs.q")
    with pytest.raises(DataError, match="finite|number"):
        column(file, "runs.q")


@pytest.mark.parametrize(
    ("first", "second", "seconds"),
    [
        ("2024-05-01T12:00:00", "2024-05-01T12:00:00.25", 0.25),
        ("2024-05-01 12:00:00Z", "2024-05-01T14:00:01+02:00", 1.0),
        ("2024-05-01T12:00:00Z", "2024-05-01T06:30:02-0530", 2.0),
        ("2024-05-01T12:00:00+01:30", "2024-05-01T12:00:00+00:30", 3600.0),
    ],
)
def test_stamps_with_an_offset_are_of_one_time(tmp_path, first, second, seconds):
    file = nested({"t": [first, second], "q": [1, 2]}, tmp_path)
    (rows,) = file.read({"t": [Column("t", clock=Clock())]}, None)
    t = rows.groups["t"][:, 0]
    assert t[1] - t[0] == pytest.approx(seconds, abs=1e-6)


def test_names_are_found_by_what_they_begin_with(tmp_path):
    file = nested({"Log": {"time": [0, 1]}, "angle [deg]": [1, 2]}, tmp_path)
    assert file.names == ("Log.time", "angle [deg]")
    assert file.match("Log.time", ()) == "Log.time"
    assert file.match("angle", ("angle",)) == "angle [deg]"
    assert file.match("angle[2]", ("angle",)) == "angle [deg][2]"
    assert file.match("nothing.time", ()) is None
    assert file.match("[1]", ()) is None
    assert column(file, "angle [deg]") == [1, 2]
    assert file.nearest("Logg") == "Log"


def test_the_last_name_of_an_address_states_the_unit(tmp_path):
    file = nested({"log_ms": {"q_deg": [[0, 1, 2], [1, 2, 3]], "t": [0, 1, 2]}, "w_deg": [1, 2]}, tmp_path)
    degree = file.unit("w_deg", ("angle",))
    assert degree is not None and degree.factor == pytest.approx(np.pi / 180.0)
    assert file.unit("log_ms.q_deg", ("angle",)) == file.unit("log_ms.q_deg[1]", ("angle",)) == degree
    assert file.unit("log_ms.t", ("time",)) is None


def test_columns_without_cells_are_one_motion(tmp_path):
    path = tmp_path / "run.json"
    path.write_text(json.dumps({"t": [0.0, 0.5, 1.0], "q": [1.0, 2.0, 4.0]}), encoding="utf-8")
    assert [table.tolist() for table in read(path, "t", "q")] == [[[0.0, 1.0], [0.5, 2.0], [1.0, 4.0]]]


def test_a_record_without_a_trial_has_no_label(tmp_path):
    file = nested([{"q": 1, "trial": None}, {"q": 2, "trial": "a"}], tmp_path)
    (rows,) = file.read({"q": [Column("q")]}, "trial")
    assert rows.labels.tolist() == ["", "a"]


def test_labels_in_bytes_are_text(tmp_path):
    np.savez(tmp_path / "run.npz", q=[1.0, 2.0], trial=np.array([b"a", b"b"]))
    (rows,) = open_source(tmp_path / "run.npz").read({"q": [Column("q")]}, "trial")
    assert rows.labels.tolist() == ["a", "b"]
