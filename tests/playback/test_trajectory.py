"""The motion between its nodes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import DataError
from playback.trajectory import Trajectory


def random_trajectory(seed: int, n: int = 12, n_joint: int = 3) -> Trajectory:
    rng = np.random.default_rng(seed)
    t = np.concatenate([[0.0], np.cumsum(rng.uniform(1e-4, 0.2, n - 1))])
    q, dq, ddq = rng.normal(size=(3, n, n_joint))
    return Trajectory(t, q, dq, ddq, "file")


@given(st.integers(0, 10_000), st.integers(2, 20), st.integers(1, 7))
def test_nodes_are_met_to_the_last_bit(seed: int, n: int, n_joint: int) -> None:
    motion = random_trajectory(seed, n, n_joint)
    for found, known in zip(motion.at(motion.t), (motion.q, motion.dq, motion.ddq), strict=True):
        np.testing.assert_array_equal(found, known)


@given(st.lists(st.floats(-3, 3), min_size=4, max_size=4), st.integers(0, 1000))
def test_a_cubic_motion_is_met_everywhere(coefficients: list[float], seed: int) -> None:
    cubic = np.polynomial.Polynomial(coefficients)
    rng = np.random.default_rng(seed)
    t = np.concatenate([[0.0], np.cumsum(rng.uniform(0.01, 0.2, 9))])
    nodes = [p(t)[:, None] for p in (cubic, cubic.deriv(1), cubic.deriv(2))]
    asked = rng.uniform(0.0, t[-1], 50)
    found = Trajectory(t, *nodes, "file").at(asked)
    for order, x in enumerate(found):
        np.testing.assert_allclose(x[:, 0], cubic.deriv(order)(asked) if order else cubic(asked), atol=1e-12)


@given(st.integers(0, 10_000))
def test_it_is_continuous_and_stands_outside(seed: int) -> None:
    motion = random_trajectory(seed)
    inner = motion.t[1:-1]
    before, after = motion.at(inner - 1e-9), motion.at(inner + 1e-9)
    for left, right in zip(before, after, strict=True):
        np.testing.assert_allclose(left, right, atol=1e-3)
    outside = motion.at(np.array([-1.0, motion.duration_s + 1.0]))
    for found, known in zip(outside, (motion.q, motion.dq, motion.ddq), strict=True):
        np.testing.assert_array_equal(found, known[[0, -1]])


def test_a_motion_may_begin_later_on_the_clock_that_asks() -> None:
    whole = replace(random_trajectory(3), lost=np.arange(12) == 4)
    late = replace(whole, begin_s=0.25)
    t = np.linspace(-0.5, whole.duration_s + 0.5, 100)
    for found, known in zip(late.at(t + 0.25), whole.at(t), strict=True):
        np.testing.assert_allclose(found, known, atol=1e-9)
    places = [(whole.t[3], whole.t[4]), (whole.t[4], whole.t[5])]
    assert [late.gap_between(a + 0.25, b + 0.25) for a, b in places] == [True, False]


@given(st.integers(0, 10_000))
def test_limits_bound_cubics_and_leave_nodes(seed: int) -> None:
    free = random_trajectory(seed)
    limited = free.within([(-0.5, 0.5), None, (0.2, 0.3)])
    np.testing.assert_array_equal(limited.at(limited.t)[0], free.q)
    t = np.linspace(0.0, free.duration_s, 400)
    left = np.clip(np.searchsorted(free.t, t, side="right") - 1, 0, len(free.t) - 2)
    ends = np.stack([free.q[left], free.q[left + 1]])
    low, high = np.array([[-0.5, -np.inf, 0.2], [0.5, np.inf, 0.3]])
    cubic = free.at(t)[0]
    np.testing.assert_array_equal(
        limited.at(t)[0],
        np.minimum(np.maximum(cubic, np.minimum(low, ends.min(0))), np.maximum(high, ends.max(0))),
    )
    assert free.within([None, None, None]) is free


def test_a_hole_is_told_only_where_it_is_bridged() -> None:
    t = np.array([0.0, 0.1, 0.2, 0.5, 0.6])
    x = np.zeros((5, 1))
    motion = Trajectory(t, x, x, x, "integrate", lost=np.array([False, False, False, True, False]))
    gaps = {
        (0.0, 0.0): False,
        (0.1, 0.2): False,
        (0.15, 0.25): True,
        (0.25, 0.3): True,
        (0.45, 0.5): True,
        (0.5, 0.6): False,
        (0.55, 0.65): False,
    }
    assert {span: motion.gap_between(*span) for span in gaps} == gaps


@pytest.mark.parametrize(
    ("t", "rows", "said"),
    [
        ([0.0], 1, "1 sample"),
        ([0.0, 0.1, 0.1], 3, "at sample 3 of 3"),
        ([0.0, 0.2, 0.1], 3, "goes from 0.2 to 0.1 s"),
        ([0.5, 0.6], 2, "begins at 0.5 s"),
        ([0.0, np.nan], 2, "t is not a finite number in sample 2"),
        ([0.0, 0.1, 0.2], 2, "expected \\(n, n_joint\\)"),
    ],
)
def test_what_cannot_be_played_is_refused(t: list[float], rows: int, said: str) -> None:
    x = np.zeros((rows, 2))
    with pytest.raises(DataError, match=said):
        Trajectory(np.array(t), x, x, x, "file")


def test_a_value_that_is_no_number_is_named() -> None:
    x = np.zeros((3, 2))
    bad = x.copy()
    bad[1, 1] = np.inf
    with pytest.raises(DataError, match="dq is not a finite number in sample 2 of 3"):
        Trajectory(np.array([0.0, 0.1, 0.2]), x, bad, x, "file")


@pytest.mark.parametrize(("span", "gaps"), [((-1.0, 0.1), False), ((-1.0, 0.3), True), ((0.25, 9.0), True)])
def test_a_hole_shows_in_spans_that_begin_or_end_outside(span: tuple[float, float], gaps: bool) -> None:
    x = np.zeros((4, 1))
    holed = Trajectory(np.array([0.0, 0.1, 0.2, 0.5]), x, x, x, "file", lost=np.array([False, False, False, True]))
    assert holed.gap_between(*span) is gaps


def test_a_motion_without_holes_tells_none() -> None:
    assert random_trajectory(0).gap_between(0.0, 9.0) is False


@pytest.mark.parametrize("shape", [(3,), (3, 2, 1), (2, 3), (4, 2)])
def test_joint_values_are_a_row_an_instant(shape: tuple[int, ...]) -> None:
    x = np.zeros(shape)
    with pytest.raises(DataError, match="the motion has 3 instants and .*, expected"):
        Trajectory(np.array([0.0, 0.1, 0.2]), x, x, x, "file")


@pytest.mark.parametrize("other", ["q", "dq", "ddq"])
def test_positions_velocities_and_accelerations_are_of_one_shape(other: str) -> None:
    x = np.zeros((3, 2))
    with pytest.raises(DataError, match="expected .n, n_joint. in all"):
        Trajectory(np.array([0.0, 0.1, 0.2]), **{"q": x, "dq": x, "ddq": x, other: x[:, :1]}, method="file")


def test_two_nodes_are_a_motion() -> None:
    x = np.array([[0.0], [3.0]])
    q, dq, ddq = Trajectory(np.array([0.0, 2.0]), x, x, x, "file").at(np.array([1.0]))
    # by hand, with s = 1/2 and a width of 2 s: (p0 + p1) / 2 + 2 (v0 - v1) / 8
    assert (q[0, 0], dq[0, 0], ddq[0, 0]) == (0.75, 0.75, 1.5)
