"""Cells of readings to a bank of filters: frames between them, rests, gaps."""

import numpy as np
import pytest

from arm.bench import Bench
from tracking.kalman.discrepancy_filter import DiscrepancyFilter
from tracking.model.decimation import Decimator
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.noise import noise_of
from tracking.model.observation import observation_of

RATE_HZ, FACTOR = 4000.0, 4


@pytest.fixture
def begun(vertical_arm, recorded):
    """Return a filter at a thousand frames a second, its readings and the truth."""
    recording = recorded(vertical_arm, Bench(RATE_HZ, learning=1, evaluating=0), 5, 1.0)
    of, size = observation_of(vertical_arm)
    readings = Decimator(FACTOR, 12).push(recording.readings[:8000])
    first = readings[:250].mean(axis=0)
    x, P = start_state(vertical_arm, of, size, first, True, recording.q[0], True, MountingPrior())
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
