"""Accelerations without their noise, against those that are known."""

import numpy as np
import pytest

from arm.accelerometer import specific_force
from tracking.model.course import course_of
from tracking.model.expected_readings import room_of
from tracking.model.observation import observation_of
from tracking.model.regression_calibration import acceleration_noise, calm

DT, N = 0.004, 1500
NOISE = 0.05


def noisy(ddq, seed=0):
    """Return states with noisy accelerations, four constants after them, and the noise's variance."""
    n_joint = ddq.shape[1]
    rng = np.random.default_rng(seed)
    states = rng.normal(size=(N, 3 * n_joint + 4))
    states[:, 2 : 3 * n_joint : 3] = ddq + NOISE * rng.normal(size=ddq.shape)
    return states, np.full(ddq.shape, NOISE**2)


def off(ddq):
    """Return the rms error of accelerations as given, and calmed."""
    states, noise = noisy(ddq)
    return [np.sqrt(np.mean((one[:, 2] - ddq[:, 0]) ** 2)) for one in (states, calm(states, noise, DT))]


def test_of_an_arm_that_hardly_accelerates_noise_is_taken_away():
    given, calmed = off(np.full((N, 1), 0.01))
    assert calmed < 0.25 * given


@pytest.mark.parametrize("hz", [1.0, 5.0, 20.0, 60.0])
def test_what_stands_out_of_the_noise_stays(hz):
    """However fast it is: a mean alone would take a vibration away, and with it what it shows."""
    t = DT * np.arange(N)
    given, calmed = off(5.0 * np.sin(2.0 * np.pi * hz * t)[:, None])
    assert calmed < 1.05 * given


def test_slopes_are_as_large_as_they_should_be():
    """What is kept is worth as much against the truth as against itself, which is all that consistency needs."""
    t = DT * np.arange(N)
    ddq = sum(NOISE * np.sin(2.0 * np.pi * hz * t + hz) for hz in (0.7, 1.3, 2.1))[:, None]
    states, noise = noisy(ddq)
    calmed = calm(states, noise, DT)[:, 2]
    assert np.mean(calmed * ddq[:, 0]) == pytest.approx(np.mean(calmed**2), rel=0.05)
    assert np.mean(states[:, 2] * ddq[:, 0]) < 0.8 * np.mean(states[:, 2] ** 2)  # as given they are not


def test_noise_is_that_of_each_joint_and_nothing_else_is_touched():
    states, noise = noisy(np.zeros((N, 2)))
    states[:, 5] *= 10.0
    noise[:, 1] *= 100.0
    before = states.copy()
    calmed = calm(states, noise, DT)
    np.testing.assert_array_equal(states, before)
    others = [k for k in range(states.shape[1]) if k not in (2, 5)]
    np.testing.assert_array_equal(calmed[:, others], states[:, others])
    assert (calmed[:, [2, 5]].std(axis=0) < 0.25 * states[:, [2, 5]].std(axis=0)).all()


@pytest.mark.parametrize("name", ["level_bench", "upright_bench"])
def test_noise_is_what_least_squares_makes_of_the_readings(name, decimated, request):
    """Against the covariance of a fit of accelerations to readings that `arm.accelerometer` makes."""
    bench = request.getfixturevalue(name)
    arm, n = bench.arm, bench.arm.n_joint
    course = course_of(decimated(bench, 250.0), n)
    of, size = observation_of(arm)
    rng = np.random.default_rng(1)
    states = np.zeros((20, size))
    states[:, : 3 * n] = rng.normal(size=(20, 3 * n))
    found = acceleration_noise(of, room_of(n), course, states)
    for k, state in enumerate(states):
        q, dq, ddq = (state[i : 3 * n : 3][None] for i in range(3))
        still = specific_force(arm, q, dq, ddq).ravel()
        slopes = [specific_force(arm, q, dq, ddq + one).ravel() - still for one in np.eye(n)]
        weighted = np.array(slopes) / np.sqrt(course.noise)
        np.testing.assert_allclose(found[k], np.diag(np.linalg.inv(weighted @ weighted.T)), rtol=1e-4)
