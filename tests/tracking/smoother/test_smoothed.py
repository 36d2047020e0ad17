"""What a smoother begins with and ends with: a course of which nothing is known, rests let go of, variances."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.model import Gyroscope
from tests.tracking.model.test_clocks import felt, read
from tracking.model.observation import observation_of
from tracking.smoother.smoothed import contradicted, is_near, mend
from tracking.smoother.smoother import Smoother, release

NAN = np.nan


@pytest.mark.parametrize(
    ("still", "expected"),
    [
        ("111111110000", "111100000000"),
        ("110000000000", "000000000000"),
        ("111111111111", "111111111111"),
        ("000000001111", "000000001111"),
        ("111111011111", "110000011111"),
        ("111111101111", "111000001111"),
        ("000000000000", "000000000000"),
        ("011110000000", "000000000000"),
        ("111111100110", "111000000000"),
    ],
)
def test_an_arm_is_let_go_of_an_eighth_of_a_second_before_it_is_seen_to_move(still, expected):
    """At 32 frames a second that is four of them."""
    found = np.array([flag == "1" for flag in still])
    course = SimpleNamespace(dt=1.0 / 32.0, rest=np.where(found, 2.0, 0.0)[:, None] * np.ones(2))
    release(course, found)
    assert "".join("01"[flag] for flag in found.astype(int)) == expected
    np.testing.assert_array_equal(course.rest, np.where(found, 2.0, 0.0)[:, None] * np.ones(2))


def test_variances_that_are_lost_are_those_between_their_neighbours():
    variance = np.array([[NAN, 1.0, NAN], [2.0, NAN, NAN], [NAN, NAN, NAN], [4.0, 7.0, NAN], [NAN, 8.0, NAN]])
    mend(variance)
    np.testing.assert_allclose(variance[:, :2], [[2.0, 1.0], [2.0, 3.0], [3.0, 5.0], [4.0, 7.0], [4.0, 8.0]])
    assert np.isnan(variance[:, 2]).all()


def test_constants_are_near_within_what_they_may_be_off(dd_arm):
    of, size = observation_of(dd_arm, mountings=True)
    x, P0 = np.zeros(size), np.eye(size) * 1e-6
    assert is_near(of, x, P0)
    for column in (int(of.length_column[0, 0]), int(of.mounting_column[2]) + 8):
        for off, expected in ((3.9e-3, True), (-4.1e-3, False)):
            moved = x.copy()
            moved[column] = off
            assert is_near(of, moved, P0) is expected
    x[2] = 1.0  # an acceleration is no constant
    assert is_near(of, x, P0)


def test_a_summary_keeps_what_was_found_and_no_frames(dd_arm):
    readings, q = felt(dd_arm, 0.0, 3.0)
    whole = Smoother(dd_arm, q[0], True).smooth(read(readings))
    summary = whole.summary
    for name in ("final", "covariance", "before", "doubted", "passes", "converged", "discrepancy", "is_near"):
        assert getattr(summary, name) is getattr(whole, name)
    assert summary.course.noise is whole.course.noise
    frames = [summary.states, summary.along, summary.still, summary.resting, *summary.found]
    frames += [getattr(summary.course, name) for name in ("readings", "present", "jolt", "doubt", "rest", "drift")]
    assert [one.size for one in frames] == [0] * len(frames)


@pytest.mark.parametrize(("size", "beyond"), [(1.05, False), (1.15, True)])
def test_readings_contradict_what_leaves_more_of_them_than_their_noise(dd_arm, size, beyond):
    """Of either kind of sensor; what was lost does not count."""
    arm = replace(dd_arm, sensors=(replace(dd_arm.sensors[0], gyroscope=Gyroscope()), *dd_arm.sensors[1:]))
    of, noise = observation_of(arm)[0], np.full(15, 0.25)
    error, there = np.full((20, 17), 2.0), np.arange(20) < 18
    error[:, 12:15] *= size
    error[18:] = 100.0
    course = SimpleNamespace(noise=noise, doubt=np.ones((20, 15)), present=there)
    assert contradicted(of, course, SimpleNamespace(error=error)) == beyond
