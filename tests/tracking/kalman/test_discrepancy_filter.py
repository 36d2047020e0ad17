"""Cells of readings to a bank of filters: frames between them, rests, gaps."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from arm.bench import Bench
from tracking.kalman.discrepancy_filter import DiscrepancyFilter
from tracking.model.decimation import Decimator
from tracking.model.first_rest import resting
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.noise import Noise, noise_of
from tracking.model.observation import observation_of

RATE_HZ, FACTOR = 4000.0, 4


@pytest.fixture
def begun(vertical_arm, recorded):
    """Return a filter at a thousand frames a second, its readings and the truth."""
    recording = recorded(vertical_arm, Bench(RATE_HZ, learning=1, evaluating=0), 5, 1.0)
    of, size = observation_of(vertical_arm)
    readings = Decimator(FACTOR, 12).push(recording.readings[:8000])
    first = readings[:250].mean(axis=0)
    x, P = start_state(vertical_arm, of, size, resting(first), recording.q[0], True, MountingPrior())
    noise = noise_of(recording.readings[:1000], RATE_HZ)
    return DiscrepancyFilter(vertical_arm, x, P, noise, FACTOR, FACTOR / RATE_HZ), readings, recording


def test_frames_within_a_cell_follow_the_motion(begun) -> None:
    one, readings, recording = begun
    course = one.follow(readings)
    q = recording.q[FACTOR // 2 :: FACTOR][: len(readings)]
    off = np.abs(course.states[:, :6:3] - q)
    assert off.max() < 0.02
    assert np.mean(off < 3.0 * np.sqrt(course.variances)) > 0.99


def test_an_arm_at_rest_is_seen_to_rest(begun) -> None:
    one, readings, _ = begun
    course = one.follow(readings)
    assert course.still[300:480].all() and course.resting[300:480].all()
    assert not course.still[600:1000].any()


def test_lost_frames_are_predicted_and_then_forgotten(begun) -> None:
    one, readings, _ = begun
    one.follow(readings[:900])
    course = one.follow(np.full((600, 12), np.nan))
    assert (np.diff(course.variances[::50, 0]) >= 0.0).all()
    assert np.sqrt(course.variances[-1]).max() == pytest.approx(0.5, rel=0.2)
    assert np.isfinite(course.states).all()


def test_the_state_is_handed_back_without_what_is_lacking(begun, vertical_arm) -> None:
    one, readings, _ = begun
    one.follow(readings[:500])
    x, P = one.state
    assert len(x) == observation_of(vertical_arm)[1] and P.shape == (len(x), len(x))
    lack, base = one.sizes
    assert 0.0 <= lack < 0.2 and 0.0 <= base < 0.2


def alike(one, other) -> None:
    for value, same in zip((*one.state, *one.sizes), (*other.state, *other.sizes), strict=True):
        np.testing.assert_array_equal(value, same)


def test_frames_that_are_skipped_are_lost_cell_by_cell(begun) -> None:
    one, readings, _ = begun
    one.follow(readings[:900])
    other = deepcopy(one)
    one.skip(49)  # four cells of ten frames; the incomplete fifth is not counted
    other.follow(np.full((40, 12), np.nan))
    alike(one, other)
    assert not one._still
    one.follow(readings[940:960])
    other.follow(readings[940:960])
    alike(one, other)


def test_other_frames_and_noise_are_those_of_a_filter_made_with_them(begun, vertical_arm) -> None:
    one, readings, _ = begun
    x, P = one.state
    noise = Noise(np.linspace(1e-4, 4e-4, 12), np.linspace(1e-6, 2e-6, 12))
    one.learn(noise)
    one.retime(1.001e-3)
    other = DiscrepancyFilter(vertical_arm, x, P, noise, FACTOR, 1.001e-3)
    courses = [some.follow(readings[:700]) for some in (one, other)]
    for value, same in zip((*one.state, *courses[0]), (*other.state, *courses[1]), strict=True):
        np.testing.assert_allclose(value, same, rtol=1e-6, atol=1e-12)


def test_a_cell_s_frames_are_where_joints_are_after_its_middle(begun) -> None:
    """A cell of ten frames is known in its middle; the last one of the next is 4.5 frames after its own."""
    one, readings, _ = begun
    one.follow(readings[:600])
    mean = one._bank.mean.copy()
    course = one.follow(readings[600:603])
    later = one.follow(readings[603:610])
    q, dq, ddq = mean[:6:3], mean[1:6:3], mean[2:6:3]
    for k, state in enumerate([*course.states, *later.states[:-1]]):
        h = 1e-3 * (5.5 + k)
        np.testing.assert_allclose(state[:6:3], q + h * dq + 0.5 * h**2 * ddq, rtol=0, atol=1e-12)
    mean, h = one._bank.mean, 4.5e-3
    expected = mean[:6:3] + h * mean[1:6:3] + 0.5 * h**2 * mean[2:6:3]
    np.testing.assert_allclose(later.states[-1, :6:3], expected, rtol=0, atol=1e-12)


def test_a_cell_with_a_hole_is_no_cell(begun) -> None:
    one, readings, _ = begun
    one.follow(readings[:900])
    other = deepcopy(one)
    holed = readings[900:910].copy()
    holed[3] = np.nan
    one.follow(holed)
    other.follow(np.full((10, 12), np.nan))
    alike(one, other)


def test_sensors_of_one_link_know_no_base_that_moves(vertical_arm) -> None:
    arm = replace(vertical_arm, sensors=vertical_arm.sensors[2:], tip=None)
    assert len({sensor.joint for sensor in arm.sensors}) == 1
    _, size = observation_of(arm)
    noise = Noise(np.full(6, 1e-4), np.zeros(6))
    one = DiscrepancyFilter(arm, np.zeros(size), np.eye(size), noise, 1, 0.01)
    assert one.sizes[1] == 0.0 and one.sizes[0] > 0.0
