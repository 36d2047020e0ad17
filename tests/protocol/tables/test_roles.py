"""Which columns of a file play which role."""

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.columns import parse_mapping
from protocol.tables.files import open_source
from protocol.tables.roles import find_roles


@pytest.fixture
def source(tmp_path):
    def opened(*names):
        np.savez(tmp_path / "run.npz", **{name: np.zeros(3) for name in names})
        return open_source(tmp_path / "run.npz")

    return opened


def addresses(plan):
    return {role: [column.address for column in columns] for role, columns in plan.columns.items()}


def test_roles_are_found_by_their_names(source):
    found = source("t", "q1", "q2", "tau1", "tau2", "tipx", "tipy", "tipz", "trial", "junk")
    plan = find_roles(found, 2, parse_mapping(None, 2), ("q",), {"tip": ("tipx", "tipy", "tipz")})
    assert addresses(plan) == {
        "t": ["t"],
        "q": ["q1", "q2"],
        "tau": ["tau1", "tau2"],
        "tip": ["tipx", "tipy", "tipz"],
    }
    assert plan.label == "trial" and not plan.stated and not plan.notes


def test_only_wanted_roles_are_looked_at(source):
    plan = find_roles(source("t", "q1", "q2", "dq1"), 2, parse_mapping(None, 2), ("q",), {}, joint_roles=("q",))
    assert addresses(plan) == {"t": ["t"], "q": ["q1", "q2"]}


def test_counting_may_begin_at_nought(source):
    plan = find_roles(source("t", "q0", "q1"), 2, parse_mapping("q=q{j-1}", 2), ("q",), {})
    assert addresses(plan)["q"] == ["q0", "q1"]


@pytest.mark.parametrize(
    ("names", "mapping", "said"),
    [
        (("t", "q1"), None, "no column 'q2' beside q1"),
        (("t", "q1", "q2", "q3"), None, "there is a column 'q3', but the arm has 2 joints"),
        (("t", "q1", "q2", "q3 [deg]"), None, r"there is a column 'q3 \[deg\]'"),
        (("t", "q1", "q2", "dq1"), None, "no column 'dq2' beside dq1"),
        (("t", "q1", "q2"), "tau=m{j}", "no column 'm1'"),
        (("t", "q1", "q2"), "q=", "nothing is mapped to 'q', which is needed"),
    ],
)
def test_what_is_missing_is_said(source, names, mapping, said):
    with pytest.raises(DataError, match=said):
        find_roles(source(*names), 2, parse_mapping(mapping, 2), ("q",), {})


def plan_of(source, *names, mapping=None, required=("q",), joint_roles=None, n_joint=2):
    more = {} if joint_roles is None else {"joint_roles": joint_roles}
    return find_roles(source(*names), n_joint, parse_mapping(mapping, n_joint), required, {}, **more)


def texts(plan):
    return [note.text for note in plan.notes]


def test_units_that_are_stated_are_heeded_and_said(source):
    plan = plan_of(source, "t [ms]", "q1_deg", "q2_deg", "tau1 [Nmm]", "tau2 [N.m]")
    (t,), q, tau = plan.columns["t"], plan.columns["q"], plan.columns["tau"]
    assert t.clock is not None and t.clock.factor == pytest.approx(1e-3) and t.factor == 1.0
    assert [column.factor for column in q] == pytest.approx([np.pi / 180.0] * 2)
    assert [column.factor for column in tau] == pytest.approx([1e-3, 1.0])
    assert plan.stated == {"t", "q1", "q2", "tau1", "tau2"}
    assert texts(plan) == [
        "t [ms] is in ms and is converted to s",
        "q1_deg, q2_deg are in deg and are converted to rad",
        "tau1 [Nmm] is in N.mm and is converted to N.m",
    ]
    assert plan.notes[1].columns == ("q1_deg", "q2_deg")


def test_the_mapping_s_unit_wins_over_the_name_s(source):
    plan = plan_of(source, "t", "a1_deg", "a2_deg", mapping="q=a{j}_deg:rad")
    assert [column.factor for column in plan.columns["q"]] == [1.0, 1.0]
    assert plan.stated == {"q1", "q2"} and not plan.notes


@pytest.mark.parametrize("name", ["time", "timestamp", "Time", "T"])
def test_time_may_go_by_another_usual_name(source, name):
    plan = plan_of(source, name, "q1", "q2")
    assert addresses(plan)["t"] == [name]
    assert texts(plan) == [f"column {name!r} is taken for 't'"] and plan.notes[0].columns == (name,)
    assert "t" not in plan_of(source, "q1", "q2", "when").columns
    assert addresses(plan_of(source, "t", "time", "q1", "q2"))["t"] == ["t"]


@pytest.mark.parametrize(("text", "step_s"), [("0.002", 0.002), ("2:ms", 0.002), ("1:s", 1.0)])
def test_a_step_may_stand_for_the_time_stamps(source, text, step_s):
    plan = plan_of(source, "q1", "q2", mapping=f"t={text}")
    assert plan.step_s == pytest.approx(step_s) and "t" not in plan.columns
    with pytest.raises(DataError, match="expected a column, or a step above 0 s"):
        plan_of(source, "q1", "q2", mapping="t=0")


def test_time_may_be_a_column_times_a_number_and_no_other_sum(source):
    plan = plan_of(source, "k", "q1", "q2", mapping="t=k*0.002")
    assert plan.columns["t"][0].clock.factor == pytest.approx(0.002)
    for wrong in ("k+k2", "k+1", "-k"):
        with pytest.raises(DataError, match="expected a column, if need be times a number above 0"):
            plan_of(source, "k", "k2", "q1", "q2", mapping=f"t={wrong}")


def test_a_role_may_be_a_sum_of_columns(source):
    plan = plan_of(source, "t", "a", "b", "q2", mapping="q1=a-b,q2=q2")
    assert addresses(plan)["q"] == ["a", "b", "q2"]
    assert plan.names["q"] == ["a-b", "q2"] and list(plan.sums) == ["q"]
    constant = plan_of(source, "t", "q1", "q2", mapping="tau1=0,tau2=1.5")
    assert "tau" not in constant.columns and list(constant.sums) == ["tau"]
    with pytest.raises(DataError, match="q1 is mapped to '1', expected a column"):
        plan_of(source, "t", "q2", mapping="q1=1,q2=q2")
    with pytest.raises(DataError, match="no column 'c'"):
        plan_of(source, "t", "a", "q2", mapping="q1=a-c,q2=q2")


def test_a_number_beside_a_column_in_another_unit_is_said(source):
    plan = plan_of(source, "t", "q1 [deg]", "q2 [deg]", mapping="q=180-q{j}")
    assert plan.sums["q"].constant.tolist() == [180.0, 180.0]
    assert texts(plan)[1:] == [
        "the number in 180-q1, 180-q2 is taken in rad, beside a column in deg; if it is in deg, "
        "expected ':deg' behind it in the mapping"
    ]


@pytest.mark.parametrize(
    ("names", "mapping"),
    [
        (("q1 [deg]", "q2 [deg]"), "q=180-q{j}:deg"),  # its unit is said
        (("q1 [rad]", "q2 [rad]"), "q=3-q{j}"),
        (("q1", "q2"), "q=3-q{j}"),
        (("q1 [deg]", "q2 [deg]"), "q=2*q{j}"),  # a factor has no unit
    ],
)
def test_a_number_in_the_unit_of_its_column_is_nothing_to_say(source, names, mapping):
    assert not any("the number in" in text for text in texts(plan_of(source, "t", *names, mapping=mapping)))


def test_a_name_with_a_sign_in_it_is_a_name(source):
    plan = plan_of(source, "t", "a-b", "a", "b", "q2", mapping="q1=a-b,q2=q2")
    assert addresses(plan)["q"] == ["a-b", "q2"] and not plan.sums


def test_gains_are_numbers_of_the_file_where_they_are_one(source):
    plan = plan_of(source, "t", "q1", "q2", "kp1", "kp2", "kv1", "kv2")
    assert all(column.per_file for role in ("kp", "kv") for column in plan.columns[role])
    assert not any(column.per_file for column in plan.columns["q"])


def test_a_label_is_a_column(source):
    assert plan_of(source, "t", "q1", "q2", "trial").label == "trial"
    assert plan_of(source, "t", "q1", "q2", "run", mapping="trial=run").label == "run"
    assert plan_of(source, "t", "q1", "q2").label is None
    with pytest.raises(DataError, match=r"trial is mapped to 'run\*2', expected a column"):
        plan_of(source, "t", "q1", "q2", "run", mapping="trial=run*2")


def test_columns_that_are_not_read_are_named(source):
    plan = plan_of(source, "t", "q1", "q2", "base_x", "kp1 [N.m/rad]")
    assert texts(plan) == ["column base_x, kp1 [N.m/rad] are not used here"]
    assert texts(plan_of(source, "t", "q1", "q2", "base_qw")) == ["column base_qw is not used here"]
    assert not texts(plan_of(source, "t", "q1", "q2", "kp"))


def test_a_drive_that_nobody_asks_for_may_not_be_mapped(source):
    with pytest.raises(DataError, match="'kp' is mapped, but this command does not ask for the drive"):
        plan_of(source, "t", "q1", "q2", "g1", "g2", mapping="kp=g{j}", joint_roles=("q",))
    plan = plan_of(source, "t", "q1", "q2", "kp1", "kp2", mapping="kp=", joint_roles=("q",))
    assert "kp" not in plan.columns


def test_a_base_that_nobody_asks_for_may_not_be_mapped(source):
    with pytest.raises(DataError, match="'base_x' is mapped, but this command does not ask for the base's pose"):
        plan_of(source, "t", "q1", "q2", "px", mapping="base_x=px")


@pytest.mark.parametrize(
    ("mapping", "said"),
    [
        ("q=angel{j}", "no column 'angel1' among its columns t, angle1, angle2; did you mean 'angle1'?"),
        (
            "q=angle{j}:degg",
            "no column 'angle1:degg' among its columns .*; 'degg' is no unit that is known, expected ",
        ),
        ("q1=angle1,q2=elbow", "no column 'elbow' beside angle1"),
    ],
)
def test_what_was_meant_is_asked(source, mapping, said):
    with pytest.raises(DataError, match=said.replace("?", r"\?")):
        plan_of(source, "t", "angle1", "angle2", mapping=mapping)


def test_a_file_without_columns_says_so(tmp_path):
    np.savez(tmp_path / "run.npz")
    with pytest.raises(DataError, match=r"among its columns \(there are none\)"):
        find_roles(open_source(tmp_path / "run.npz"), 1, parse_mapping(None, 1), ("q",), {})


def test_a_header_without_values_counts_as_not_given(tmp_path):
    (tmp_path / "run.csv").write_text("t,q1,dq1,trial\n0,1,,\n1,2,,\n2,3,,\n")
    plan = find_roles(open_source(tmp_path / "run.csv"), 1, parse_mapping(None, 1), ("q",), {})
    assert "dq" not in plan.columns and plan.label is None
    assert "dq1: there is a header and no value, so dq counts as not given" in texts(plan)
    asked = find_roles(open_source(tmp_path / "run.csv"), 1, parse_mapping("dq=dq1", 1), ("q",), {})
    assert "dq" in asked.columns


@pytest.mark.parametrize(("n_joint", "arm"), [(1, "1 joint$"), (2, "2 joints$")])
def test_a_column_beyond_the_last_joint_is_one_too_many(source, n_joint, arm):
    names = [f"q{k + 1}" for k in range(n_joint + 1)]
    with pytest.raises(DataError, match=f"there is a column 'q{n_joint + 1}', but the arm has {arm}"):
        plan_of(source, "t", *names, n_joint=n_joint)
