"""Sensors whose clocks differ: what moving readings back does, and a late sensor that is found."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.model import Arm
from tracking.model.clocks import CLOCK_STD_S, ClockSearch, moved_back
from tracking.model.course import course_of
from tracking.model.observation import ABSENT
from tracking.model.readings import Readings, ReadingsBuilder
from tracking.smoother.smoothed_frames import most_probable

RATE_HZ, NOISE = 100.0, 0.02


def read(values: np.ndarray, noise: float = NOISE) -> Readings:
    builder = ReadingsBuilder(RATE_HZ, values.shape[1], RATE_HZ)
    builder.push(values + noise * np.random.default_rng(0).standard_normal(values.shape))
    return builder.done()


def swing(t: np.ndarray) -> np.ndarray:
    since = np.maximum(t - 1.0, 0.0)[:, None]
    return (1.0 - np.exp(-(since**3))) * 0.6 * np.sin(2.0 * np.pi * np.array([0.5, 0.8]) * since)


def felt(arm: Arm, late_s: float, seconds: float = 8.0) -> tuple[np.ndarray, np.ndarray]:
    """Return readings whose last sensor is late, and the angles."""
    t, h = np.arange(0.0, seconds, 1.0 / RATE_HZ), 1e-4

    def readings(at: np.ndarray) -> np.ndarray:
        q, dq = swing(at), (swing(at + h) - swing(at - h)) / (2.0 * h)
        ddq = (swing(at + h) - 2.0 * swing(at) + swing(at - h)) / h**2
        return specific_force(arm, q, dq, ddq).reshape(len(at), -1)

    return np.hstack([readings(t)[:, :9], readings(t - late_s)[:, 9:]]), swing(t)


@pytest.mark.parametrize("late_s", [0.013, -0.02])
def test_readings_are_those_of_the_instants_that_they_are_of(vertical_arm: Arm, late_s: float) -> None:
    stamped, _ = felt(vertical_arm, late_s)
    true, _ = felt(vertical_arm, 0.0)
    course = course_of(read(true, 0.0), 2)
    moved = moved_back(course, stamped, np.array([0.0, 0.0, 0.0, late_s]))
    inside = slice(150, -10)
    np.testing.assert_allclose(moved.readings[inside], true[inside], atol=2e-3)
    np.testing.assert_allclose(moved.drift[inside], np.gradient(true, 1.0 / RATE_HZ, axis=0)[inside], atol=1.0)
    np.testing.assert_array_equal(moved_back(course, stamped, np.zeros(4)).readings, stamped)


def test_lost_readings_have_no_say(vertical_arm: Arm) -> None:
    true, _ = felt(vertical_arm, 0.0)
    one = read(true)
    one.values[300:320] = np.nan
    course = course_of(one, 2)
    moved = moved_back(course, course.readings, np.full(4, 0.01))
    clean = moved_back(course_of(read(true), 2), read(true).values, np.full(4, 0.01))
    assert np.abs(moved.readings - clean.readings)[np.r_[200:297, 323:500]].max() < 0.05
    assert np.isfinite(moved.drift).all()


def test_a_late_sensor_is_found_and_the_motion_with_it(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.015)
    found = most_probable(vertical_arm, read(readings), q[0], True)
    assert found.is_exact and found.clocks is not None
    late, std = found.clocks
    assert std[0] == 0.0 and std[1:].max() < 2e-3
    assert np.all(np.abs(late - [0.0, 0.0, 0.0, 0.015]) < 4.0 * std + 1e-9)
    off = np.abs(found.states[:, :6:3] - q)
    assert np.mean(off < 3.0 * np.sqrt(found.variance[:, ::3])) > 0.97


def test_readings_are_moved_anew_from_a_tenth_of_what_is_not_known() -> None:
    """Two sensors, the second's clock in the state's first column; known to 1 ms after the pass."""
    sought: Any = SimpleNamespace(clock_column=np.array([ABSENT, 0]), link=np.zeros(2))
    P = np.diag([1e-6, 1.0])
    for left_s, anew in ((0.9e-4, False), (-0.9e-4, False), (1.1e-4, True), (-1.1e-4, True)):
        search = ClockSearch(sought, np.zeros((5, 6)))
        x0, at = np.zeros(2), np.zeros((5, 2))
        assert search.take(np.array([left_s, 7.0]), P, x0, at) is anew
        assert search.late_s.tolist() == [0.0, left_s * anew]
        assert x0.tolist() == [-left_s * anew, 0.0] and np.all(at == x0)


def test_a_covariance_without_digits_is_of_a_clock_that_is_moved_anew() -> None:
    sought: Any = SimpleNamespace(clock_column=np.array([ABSENT, 0]), link=np.zeros(2))
    search, P = ClockSearch(sought, np.zeros((5, 6))), np.diag([-1e-12, 1.0])
    assert search.take(np.array([1e-4, 0.0]), P, np.zeros(2), np.zeros((5, 2)))
    found = search.found(np.zeros(2), P)
    assert found is not None and found.std_s.tolist() == [0.0, 0.0]


def test_a_clock_begins_unknown_by_a_few_packets() -> None:
    sought: Any = SimpleNamespace(clock_column=np.array([ABSENT, 0]), link=np.zeros(2))
    x, P = np.ones(2), np.ones((2, 2))
    ClockSearch(sought, np.zeros((5, 6))).begin(x, P)
    assert x.tolist() == [0.0, 1.0]
    assert P.tolist() == [[CLOCK_STD_S**2, 0.0], [0.0, 1.0]]
