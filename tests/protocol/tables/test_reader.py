"""Every way in which programs write tables, read whole and block by block alike."""

import io
import math

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.columns import parse_mapping
from protocol.tables.reader import read_tables
from tests.protocol.tables.written_tables import N, Q, T, read, text_of, written


def savetxt(**options):
    file = io.BytesIO()
    np.savetxt(file, np.column_stack([T, Q]), **options)
    return file.getvalue()


WAYS = {
    "plain": text_of("t,q1,q2"),
    "semicolons": text_of("t;q1;q2", sep=";"),
    "decimal comma": text_of("t;q1;q2", sep=";", decimal=","),
    "decimal comma, tabs": text_of("t\tq1\tq2", sep="\t", decimal=","),
    "decimal comma, commas in names": text_of('t;q1;q2;"Zeit, s"', sep=";", decimal=",", trail=";0,5"),
    "savetxt": savetxt(header="t,q1,q2", delimiter=","),
    "savetxt, blanks": savetxt(header="t q1 q2"),
    "savetxt, blanks, names by commas": savetxt(header="t,q1,q2"),
    "savetxt, two lines of header": savetxt(header="made by us, today\nt,q1,q2", delimiter=","),
    "MATLAB": text_of("t,q1,q2", comment="%"),
    "MATLAB, aligned": "% t q1 q2\n" + text_of("", sep="   ").lstrip("\n"),
    "remarks and a header": text_of("t,q1,q2", first="# a device, x, y\n% more\n\n"),
    "remarks behind the header": text_of("t,q1,q2\n# units: SI\n# none"),
    "quotes": text_of('"t","q1","q2"'),
    "commas in quotes": text_of('t,q1,q2,"name, given"', trail=',"a, b"'),
    "sep=": text_of("t;q1;q2", sep=";", first="sep=;\n"),
    "sep= with a decimal comma": text_of("t;q1;q2", sep=";", decimal=",", first="sep=;\r\n", end="\r\n"),
    "units below": text_of("t;q1;q2\ns;rad;rad", sep=";"),
    "units below, in brackets": text_of("t,q1,q2\n[s],[rad],[rad]"),
    "units below, some": text_of("t,q1,q2,trial\n[s],[rad],[rad],[-]", trail=",7"),
    "trailing commas": text_of("t,q1,q2,", trail=","),
    "trailing commas, not in the header": text_of("t,q1,q2", trail=","),
    "trailing commas, only in the header": text_of("t,q1,q2,"),
    "empty columns": text_of("t,q1,q2,,dq1,dq2", trail=",,,"),
    "empty lines at the end": text_of("t,q1,q2") + "\n,,\n\n",
    "blank lines": text_of("\n\nt,q1,q2\n", end="\n\n"),
    "cp1252": text_of("t,q1,q2,Größe", trail=",böse").encode("cp1252"),
    "UTF-8 with a mark": text_of("t,q1,q2").encode("utf-8-sig"),
    "UTF-16": text_of("t,q1,q2,Größe", trail=",ü").encode("utf-16"),
    "UTF-16 without a mark": text_of("t;q1;q2", sep=";", decimal=",").encode("utf-16-le"),
    "Windows": text_of("t,q1,q2", end="\r\n"),
    "an unused column twice": text_of("t,q1,q2,x,x", trail=",1,"),
    "an unused column of text": text_of("t,q1,q2,remark", trail=",none"),
    "an unused column with holes": text_of("t,q1,q2,temperature", trail=",NaN"),
    "no line end at the end": text_of("t,q1,q2").rstrip("\n"),
    "zeros at the end": text_of("t,q1,q2").encode() + b"\0" * 100,
    "decimal comma, all in quotes": text_of('"t","q1","q2"', sep='","', decimal=",", trail='"').replace(
        "\n", '\n"'
    ),
    "a name with a line's end in it": text_of('t,q1,q2,"torque\nmeasured"', trail=",1"),
    "bars": text_of("t|q1|q2", sep="|"),
    "a preamble": text_of("t,q1,q2", first="Device 7\nSerial,42\n\n"),
    "apostrophes": text_of("'t','q1','q2'"),
    "old line ends": text_of("t,q1,q2", end="\r"),
    "an index without a name": text_of(",t,q1,q2").replace("\n", "\n0,").removesuffix("0,"),
    "a name for time": text_of("Time,q1,q2"),
}


@pytest.mark.parametrize("way", WAYS)
def test_every_way_of_writing_a_table_reads_alike(tmp_path, way):
    table = read(written(tmp_path, WAYS[way]))
    assert np.allclose(table.groups["t"][:, 0], T, atol=1e-6)
    assert np.allclose(table.groups["q"], Q, atol=1e-6)
    assert set(table.groups) == {"t", "q"}


@pytest.mark.parametrize("cut", [1, 5, 9, 12, 20])
def test_a_last_line_that_is_cut_is_said_and_the_rest_is_used(tmp_path, cut):
    whole = text_of("t,q1,q2,ref1,ref2", trail=",0.125000,0.250000").rstrip("\n")
    table = read(written(tmp_path, whole[: -cut - 8]))
    assert np.allclose(table.groups["q"], Q[:-1], atol=1e-6)
    (note,) = table.notes
    assert note.kind == "cut" and "left out" in note.text


def test_a_number_that_is_cut_is_left_out_too(tmp_path):
    rows = [f"{0.01 * k:.6f},0.5,{0.125 + 0.01 * k:.6f}" for k in range(200)]
    whole = "\n".join(["t,q1,q2", *rows])
    assert len(read(written(tmp_path, whole)).groups["q"]) == 200
    table = read(written(tmp_path, whole[:-4]))
    assert len(table.groups["q"]) == 199 and "ends within a number" in table.notes[0].text


def test_a_short_line_that_is_not_the_last_is_an_error(tmp_path):
    lines = text_of("t,q1,q2").splitlines()
    lines[20] = "0.1,2"
    with pytest.raises(DataError, match=r"run\.csv: row 20: 2 cells, expected 3 as in the header"):
        read(written(tmp_path, "\n".join(lines)))


DEGREES = [
    ("t [ms],q1 [deg],q2 [deg]", None),
    ("t (ms),q1 (°),q2 (deg)", None),
    ("t_ms,q1_deg,q2_deg", None),
    ("t / ms,q1 in deg,q2 / degrees", None),
    ("time (ms),angle1 [deg],angle2 [deg]", "t=time,q=angle{j}"),
    ("time [ms],angle1 [deg],angle2 [deg]", "q=angle{j}"),
    ("time (ms),angle0_deg,angle1_deg", "t=time (ms),q=angle{j-1}_deg"),
    ("stamp,pos1,pos2", "t=stamp:ms,q=pos{j}:deg"),
    ("t,q1,q2\nms,deg,deg", None),
    ("t,q1,q2\n[ms],[°],[deg]", None),
    ("t,q1,q2\n# ms,deg,deg", None),
    ("# t,q1,q2\n# ms,deg,deg", None),
    ("t (MS),q1 (DEG),q2 (Degrees)", None),
    ("t [s],q1 [rad],q2 [rad]", "t=t:ms,q=q{j}:deg"),
]


@pytest.mark.parametrize(("header", "columns"), DEGREES)
def test_units_are_heeded_wherever_they_stand(tmp_path, header, columns):
    rows = [
        f"{1e3 * t!r},{math.degrees(a)!r},{math.degrees(b)!r}"
        for t, (a, b) in zip(T.tolist(), Q.tolist(), strict=True)
    ]
    table = read(written(tmp_path, "\n".join([header, *rows, ""])), columns)
    assert np.allclose(table.groups["t"][:, 0], T) and np.allclose(table.groups["q"], Q)
    assert table.stated == {"t", "q1", "q2"}
    units = [note for note in table.notes if note.kind == "unit"]
    assert len(units) == 2 and any("in ms" in note.text for note in units)


def test_torques_and_readings_have_units_too(tmp_path):
    content = "t,q1,tau1 [Nmm],dq1 [deg/s],tip_z\n" + "\n".join(f"{k},0,{k},180,0" for k in range(20))
    table = read(written(tmp_path, content), n_joint=1)
    assert np.allclose(table.groups["tau"][:, 0], 1e-3 * np.arange(20))
    assert np.allclose(table.groups["dq"], np.pi)
    assert table.stated == {"tau1", "dq1"}
    path = written(tmp_path, "t,s1x [g],s1y_m_s2,s1z_g\n0,1,2,3\n1,1,2,3\n", "raw.csv")
    mapping = parse_mapping(None, 1, ["s1x", "s1y", "s1z"])
    (table,) = read_tables(path, 1, mapping, ("a",), vectors={"a": ["s1x", "s1y", "s1z"]})
    assert np.allclose(table.groups["a"][0], [9.80665, 2.0, 3 * 9.80665])


@pytest.mark.parametrize(
    ("header", "columns", "said"),
    [
        ("t,q1 [ms],q2 [ms]", None, "column 'q1 [ms]' is in ms, which measures a time; expected one of rad"),
        ("t,q1_ms,q2_ms", None, "column 'q1_ms' is in ms"),
        ("t [deg],q1,q2", None, "column 't [deg]' is in deg, which measures an angle; expected one of s, ms"),
        ("t,q1,q2\ns,furlong,rad", None, "column 'q1' is in 'furlong', expected one of rad"),
        ("t,q1 [rad],q1 [deg]", None, "'q1' may be any of the columns q1 [rad], q1 [deg]"),
        ("t,angle1,angle2", "q=angle{j}:grad", "'grad' is no unit that is known"),
        ("t,Q1,Q2", None, "no column 'q1' among its columns t, Q1, Q2; did you mean 'Q1'?"),
        ("t,pos_1,pos_2", "q=pos{j}", "no column 'pos1' among its columns t, pos_1, pos_2; did you mean 'pos_1'?"),
        ("t,q1,q1", None, "column 'q1' is there 2 times, expected once"),
    ],
)
def test_what_does_not_fit_is_said(tmp_path, header, columns, said):
    rows = "".join("0,1,2\n" for _ in range(20))
    with pytest.raises(DataError) as caught:
        read(written(tmp_path, f"{header}\n{rows}"), columns)
    assert said in str(caught.value) and str(caught.value).startswith(str(tmp_path / "run.csv"))


def test_columns_that_are_not_read_yet_are_said(tmp_path):
    table = read(written(tmp_path, text_of("t,q1,q2,kp1 [N.m/rad],base_x", trail=",1,0")))
    (note,) = table.notes
    assert note.kind == "unused" and note.columns == ("kp1 [N.m/rad]", "base_x")


def test_drives_are_read_by_their_names(tmp_path):
    table = read(written(tmp_path, text_of("t,q1,q2,on1,on2,kp1,kp2", trail=",1,0,9.5,2")))
    assert not table.notes
    assert np.array_equal(table.groups["on"], np.tile([1.0, 0.0], (N, 1)))
    assert np.array_equal(table.groups["kp"], np.tile([9.5, 2.0], (N, 1)))
    with pytest.raises(DataError, match="no column 'on2' beside on1"):
        read(written(tmp_path, text_of("t,q1,q2,on1", trail=",1")))
    with pytest.raises(DataError, match="no column 'enabled'"):
        read(written(tmp_path, text_of("t,q1,q2")), "on=enabled")
    with pytest.raises(DataError, match="'kp2' is mapped, but this command does not ask"):
        read_tables(tmp_path / "run.csv", 2, parse_mapping("kp2=q2", 2), ("q",), joint_roles=("q",))


def test_sums_of_columns(tmp_path):
    path = written(tmp_path, text_of("tick,a-b,a,b [deg]", trail=",90"))
    table = read(path, "t=tick*2,q1=a-b,q2=-1*a+pi,tau1=a/2,tau2=0,on=1,kp=95/10")
    assert np.allclose(table.groups["t"][:, 0], 2 * T)
    assert np.allclose(table.groups["q"], np.column_stack([Q[:, 0], np.pi - Q[:, 1]]), atol=1e-6)
    assert np.allclose(table.groups["kp"], 9.5) and np.all(table.groups["on"] == 1.0)


def test_a_sum_in_degrees(tmp_path):
    path = written(tmp_path, text_of("t,a,b"))
    table = read(path, "q1=b-a+180:deg,q2=b-a:deg")
    expected = np.deg2rad(np.column_stack([Q[:, 1] - Q[:, 0] + 180.0, Q[:, 1] - Q[:, 0]]))
    assert np.allclose(table.groups["q"], expected, atol=1e-6)
    assert table.stated == {"q1", "q2"}


def test_a_step_stands_in_the_place_of_time(tmp_path):
    path = written(tmp_path, text_of("junk,q1,q2"))
    for step in ("0.004", "4:ms"):
        table = read(path, f"t={step}")
        assert np.allclose(table.groups["t"][:, 0], 0.004 * np.arange(N)) and "t" in table.stated
        assert table.origin_s == 0.0


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ("q1=a*b,q2=b", r"no column 'a\*b'"),
        ("q1=a-c,q2=b", "no column 'c'"),
        ("q1=1,q2=b", "q1 is mapped to '1', expected a column"),
        ("q1=a,q2=b,t=0", "expected a column, or a step above 0 s"),
        ("q1=a,q2=b,t=t-1", "expected a column"),
        ("q1=a,q2=b,trial=a+1", "trial is mapped to 'a\\+1', expected a column"),
    ],
)
def test_a_sum_that_cannot_be_is_said(tmp_path, columns, said):
    with pytest.raises(DataError, match=said):
        read(written(tmp_path, text_of("t,a,b")), columns)


def test_empty_columns_count_as_not_given_and_are_said(tmp_path):
    table = read(written(tmp_path, text_of("t,q1,q2,dq1,dq2", trail=",,")))
    (note,) = table.notes
    assert note.kind == "empty" and note.columns == ("dq1", "dq2")
    with pytest.raises(DataError, match="column 'dq1', row 1: found nothing or NaN"):
        read(written(tmp_path, text_of("t,q1,q2,dq1,dq2", trail=",,")), "dq=dq{j}")
