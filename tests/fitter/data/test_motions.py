"""Motions out of files: trials, time, joints."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.io import savemat

from fitter.data.motions import Measured, read_motions, trial_column
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.columns import parse_mapping


def read(tmp_path, text, n_joint=2, columns=None, rate_hz=None, required=("q",)):
    path = tmp_path / "run.csv"
    path.write_text(text)
    return read_motions(path, n_joint, parse_mapping(columns, n_joint), rate_hz, required)


def test_columns_by_their_own_names(tmp_path):
    (motion,) = read(tmp_path, "t,q1,q2,tau1,tau2,tipx,tipy,tipz,who\n5,1,2,3,4,7,8,9,a\n6,1,2,3,5,7,8,9,b\n")
    assert motion.name == "run"
    assert motion.t.tolist() == [5.0, 6.0]
    assert set(motion.columns) == {"q", "tau", "tip"}
    assert motion.columns["tau"].tolist() == [[3, 4], [3, 5]]
    assert motion.columns["tip"].shape == (2, 3)


def test_a_trial_column_parts_a_file_whether_or_not_the_clock_goes_on(tmp_path):
    motions = read(tmp_path, "t,q1,trial\n0,1,a\n1,2,a\n0,3,b\n1,4,b\n2,5,7\n3,6,7\n", n_joint=1)
    assert [motion.name for motion in motions] == ["run/a", "run/b", "run/7"]
    assert [motion.first_row for motion in motions] == [0, 2, 4]
    assert motions[2].columns["q"][:, 0].tolist() == [5, 6]


def test_samples_without_time_have_a_rate(tmp_path):
    (motion,) = read(tmp_path, "q1\n1\n2\n3\n", n_joint=1, rate_hz=10.0)
    assert np.allclose(motion.t, [0, 0.1, 0.2])


def test_a_column_can_be_left_out(tmp_path):
    (motion,) = read(tmp_path, "t,q1,q2,dq1,dq2\n0,1,2,3,4\n", columns="dq=")
    assert set(motion.columns) == {"q"}


@pytest.mark.parametrize(
    ("text", "columns", "said"),
    [
        ("t,q1,q2\n0,1,2\n", "q=pos{j}", "no column 'pos1' among its columns t, q1, q2"),
        ("t,q1,q2\n0,1,2\n", "t=time", "no column 'time' among its columns t, q1, q2"),
        ("t,a,b\n0,1,2\n", None, "no column 'q1' among its columns t, a, b"),
        ("t,q1\n0,1\n", None, "no column 'q2' beside q1 among its columns t, q1"),
        ("t,q1,q2,dq1\n0,1,2,3\n", None, "no column 'dq2' beside dq1"),
        ("t,q1,q2,tipx,tipz\n0,1,2,3,4\n", None, "no column 'tipy' beside tipx, tipz"),
        ("t,q1,q2,q3\n0,1,2,3\n", None, "there is a column 'q3', but the arm has 2 joints"),
        ("t,p1,p2,p3\n0,1,2,3\n", "q=p{j}", "there is a column 'p3', but the arm has 2 joints"),
        ("q1,q2\n0,1\n", None, "no column 't' among its columns q1, q2"),
        ("t,q1,q2\n", None, "no row"),
        ("t,q1,q2\n0,1,1\n", "q=", "nothing is mapped to 'q'"),
        ("t,q1,q2\n0,1,1\n1,1,1\n0.5,1,1\n", None, "in row 3 time runs backwards from 1 s to 0.5 s"),
        ("t,q1,q2\n0,1,1\n1,1,1\n1,1,1\n", None, "in row 3 time stands still at 1 s"),
        ("t,q1,q2,trial\n3,1,1,1\n1,1,1,2\n0,1,1,2\n", None, "in row 3 time runs backwards from 1 s to 0 s"),
        ("t,q1,q2,trial\n3,1,1,1\n1,1,1,2\n4,1,1,1\n", None, "trial '1' goes on in row 3"),
    ],
)
def test_what_does_not_fit_is_said(tmp_path, text, columns, said):
    with pytest.raises(DataError) as caught:
        read(tmp_path, text, columns=columns)
    assert said in str(caught.value)
    assert "run.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_joints_named_one_by_one_may_be_some_of_many(tmp_path):
    (motion,) = read(tmp_path, "t,p1,p2,p3\n0,1,2,3\n", columns="q1=p1,q2=p3")
    assert motion.columns["q"].tolist() == [[1, 3]]


def test_rows_of_a_motion_are_a_motion():
    note, other = Note("unit", "degrees"), Note("gap", "parted")
    whole = Measured(
        *("run", "run.csv", 3, np.arange(6.0), {"q": np.arange(12.0).reshape(6, 2)}),
        **{"role": "learn", "notes": (note,), "labels": np.array(list("aabbcc")), "stated": frozenset({"q1"})},
    )
    part = whole.rows(2, 5, "part", other)
    assert (part.name, part.where, part.first_row, part.role) == ("part", "run.csv", 5, "learn")
    assert part.t.tolist() == [2.0, 3.0, 4.0] and part.columns["q"].tolist() == [[4, 5], [6, 7], [8, 9]]
    assert part.notes == (note, other) and part.labels.tolist() == ["b", "b", "c"] and part.stated == {"q1"}
    assert replace(whole, labels=None).rows(0, 1, "one").labels is None


def test_what_is_noted_of_a_file_is_said_with_its_first_trial(tmp_path):
    text = "t,q1_deg,trial\n0,90,a\n1,90,a\n0,180,b\n1,180,b\n"
    first, second = read(tmp_path, text, n_joint=1, columns="q1=q1_deg:deg")
    assert second.notes == () and (first.first_row, second.first_row) == (0, 2)
    assert second.columns["q"][:, 0] == pytest.approx([np.pi, np.pi])


def test_cells_of_a_file_are_counted_from_one(tmp_path):
    cells = np.empty((1, 2), dtype=object)
    cells[0, 0], cells[0, 1] = np.arange(4.0)[:, None], np.arange(5.0)[:, None]
    for n, names in ((1, ["run"]), (2, ["run(1)", "run(2)"])):
        savemat(tmp_path / "run.mat", {"T": cells[:, :n], "Y": cells[:, :n]})
        motions = read_motions(tmp_path / "run.mat", 1, parse_mapping("t=T,q1=Y[1]", 1), None, ("q",))
        assert [motion.name for motion in motions] == names
        assert [len(motion.t) for motion in motions] == [4, 5][:n]


@pytest.mark.parametrize(
    ("labels", "numbers", "column"),
    [
        (("3", "4"), [3, 4], [3, 4]),
        (("a", "4"), [1, 4], ["a", "4"]),
        (("push", "rest"), [1, 2], ["push", "rest"]),
        (("2", "2"), [2, 2], [1, 2]),
        (None, [1, 2], [1, 2]),
    ],
)
def test_trials_keep_their_labels_where_these_differ(tmp_path, labels, numbers, column):
    trials = [
        Measured("m", "m.csv", 0, np.arange(2.0), {}, labels=labels and np.array([label, label]))
        for label in labels or (None, None)
    ]
    assert [trial.identity(place).number for place, trial in enumerate(trials, 1)] == numbers
    assert trial_column(trials) == column
