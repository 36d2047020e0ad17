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
