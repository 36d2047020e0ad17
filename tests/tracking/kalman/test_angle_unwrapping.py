"""Whole turns in a gap, put in and taken out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracking.kalman.angle_unwrapping import unwound
from tracking.model.course import Course

DT, N = 0.004, 1500
GAP = slice(500, 800)
T = (GAP.stop - GAP.start + 1) * DT


def motion(speeds: list[float]) -> np.ndarray:
    """Return states of joints that go on evenly."""
    t = DT * np.arange(N)
    states = np.zeros((N, 3 * len(speeds) + 1))
    for j, speed in enumerate(speeds):
        states[:, 3 * j], states[:, 3 * j + 1] = speed * t, speed
    return states


def course(n_joint: int = 2, lost: slice = GAP) -> Course:
    """Return a course of which only what is looked at is of any sense."""
    present, nothing, zeros = np.ones(N, dtype=np.bool_), np.zeros((N, 3)), np.zeros((N, n_joint))
    present[lost] = False
    return Course(
        DT,
        nothing,
        present,
        np.ones(3),
        np.zeros(3),
        np.ones(n_joint),
        zeros,
        np.ones((N, 3)),
        zeros,
        np.zeros(n_joint),
    )


def wound(states: np.ndarray, joint: int, turns: int) -> np.ndarray:
    """Return the motion with so many turns more in the gap."""
    more = states.copy()
    more[:, 3 * joint] += 2.0 * np.pi * turns * np.clip((np.arange(N) - GAP.start + 1) * DT / T, 0.0, 1.0)
    more[GAP, 3 * joint + 1] += 2.0 * np.pi * turns / T
    return more


@given(
    speeds=st.lists(st.floats(-8.0, 8.0), min_size=2, max_size=2),
    joint=st.integers(0, 1),
    turns=st.integers(-3, 3).filter(bool),
)
def test_turns_are_taken_out(dd_arm, speeds, joint, turns):
    states = motion(speeds)
    np.testing.assert_allclose(unwound(wound(states, joint, turns), course(), dd_arm), states, atol=1e-9)


@given(speeds=st.lists(st.floats(-8.0, 8.0), min_size=2, max_size=2), more=st.floats(-3.0, 3.0))
def test_what_is_no_whole_turn_stays(dd_arm, speeds, more):
    states = motion(speeds)
    states[GAP.stop :, 0] += more
    assert unwound(states, course(), dd_arm) is None


def test_without_a_gap_a_joint_may_turn_as_it_likes(dd_arm):
    assert unwound(motion([40.0, -40.0]), course(lost=slice(0)), dd_arm) is None


@pytest.mark.parametrize("joint", [0, 1])
def test_a_joint_that_slides_does_not_turn(sliding, joint):
    states = wound(motion([0.3, 0.2]), joint, 1)
    left = unwound(states, course(), sliding)
    assert (left is None) == (sliding.joints[joint].type == "prismatic")


def test_turns_that_cancel_are_taken_out_one_by_one(dd_arm):
    """One way round in the first gap and back in the second: after both nothing is off, between them it is."""
    states, lost = motion([1.0, -1.0]), [slice(500, 600), slice(900, 1000)]
    present = np.ones(N, dtype=np.bool_)
    off = states.copy()
    for gone, turns in zip(lost, (1.0, -1.0), strict=True):
        present[gone] = False
        off[gone.stop :, 0] += 2.0 * np.pi * turns
    found = unwound(off, course()._replace(present=present), dd_arm)
    np.testing.assert_allclose(found[present], states[present], atol=1e-9)


@pytest.mark.parametrize("turns", [-2, 1])
def test_after_a_long_gap_a_joint_is_about_where_it_was(dd_arm, turns):
    """And only where that is asked for: what is then found of it is not put right again and again."""
    long = slice(500, 1000)
    states = motion([0.5, 0.0])
    states[long.stop :, 0] += 2.0 * np.pi * turns
    assert unwound(states, course(lost=long), dd_arm) is None
    found = unwound(states, course(lost=long), dd_arm, long_too=True)
    assert abs(found[long.stop, 0] - states[long.start - 1, 0]) < np.pi


@pytest.mark.parametrize(
    ("lost", "speed"), [(slice(1, 301), 3.0), (slice(N - 301, N - 1), -4.0), (slice(3, 303), 6.5)]
)
def test_a_gap_at_either_end_has_one_reading_to_go_by(dd_arm, lost, speed):
    states = motion([speed, 0.3])
    way_s = (lost.stop - lost.start + 1) * DT
    more = states.copy()
    more[:, 0] += 4.0 * np.pi * np.clip((np.arange(N) - lost.start + 1) * DT / way_s, 0.0, 1.0)
    more[lost, 1] += 4.0 * np.pi / way_s
    np.testing.assert_allclose(unwound(more, course(lost=lost), dd_arm), states, atol=1e-9)


@pytest.mark.parametrize(
    ("speeds", "turned"),
    [
        ([0.0, 5.3, 5.3, 5.3, 5.3, 5.3], True),  # at 5.22 rad/s it comes half a turn far in 1.2 s, braking
        ([0.0, 5.1, 5.1, 5.1, 5.1, 5.1], False),
        ([0.0, 7.2, 4.9, 4.9, 4.9, 4.9], True),  # the mean of five instants counts
        ([9.0, 5.1, 5.1, 5.1, 5.1, 5.1], False),
    ],
)
@pytest.mark.parametrize("end", [False, True])
def test_speeds_at_an_end_are_means_of_a_fiftieth_of_a_second(dd_arm, speeds, turned, end):
    states = motion([0.0, 0.0])
    if end:
        states[GAP.stop : GAP.stop + 6, 1] = speeds[::-1]
    else:
        states[GAP.start - 6 : GAP.start, 1] = speeds
    found = unwound(states, course(), dd_arm)
    assert (found is not None) == turned
    if turned:
        np.testing.assert_allclose(found[GAP.stop :, 0], 2.0 * np.pi, atol=1e-12)


@pytest.mark.parametrize(
    ("where", "acceleration", "way"),
    [(slice(0, 500), 30.0, 1.0), (slice(0, 500), -30.0, -1.0), (slice(800, N), 30.0, -1.0)],
)
def test_accelerations_at_the_ends_tell_too(dd_arm, where, acceleration, way):
    """T^2 / 12 of their difference: 3.6 rad in 1.2 s."""
    states = motion([0.0, 0.0])
    states[where, 2] = acceleration
    found = unwound(states, course(), dd_arm)
    np.testing.assert_allclose(found[GAP.stop :, 0], 2.0 * np.pi * way, atol=1e-12)
    states[where, 2] = acceleration / 1.5
    assert unwound(states, course(), dd_arm) is None


@pytest.mark.parametrize(("frames", "told"), [(374, True), (375, False)])
def test_a_gap_of_one_and_a_half_seconds_is_told(dd_arm, frames, told):
    lost = slice(500, 500 + frames)
    states = motion([0.0, 0.0])
    states[lost.stop :, 0] += 2.0 * np.pi
    assert (unwound(states, course(lost=lost), dd_arm) is not None) == told


def test_one_lost_reading_is_a_gap(dd_arm):
    lost, states = slice(500, 501), motion([0.0, 0.0])
    states[lost.stop :, 0] -= 2.0 * np.pi
    found = unwound(states, course(lost=lost), dd_arm)
    np.testing.assert_allclose(found[lost.stop :, 0], 0.0, atol=1e-12)
    assert found[500, 0] == pytest.approx(np.pi)  # half way, as a turn would have had it
    assert found[500, 1] == pytest.approx(2.0 * np.pi / (2.0 * DT))
