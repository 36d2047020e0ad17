"""Readings along a motion against the accelerometers' own equation."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from fitter.reading_diagnosis.elimination import motion_at_knots
from fitter.reading_diagnosis.linearisation import instruments_of, linearise, turn_by_angles
from fitter.reading_diagnosis.sensor_frames import trials_of


@pytest.fixture(scope="module")
def trial(measured_run):
    return measured_run.arm, trials_of(measured_run.arm, measured_run.learn[:1])[0]


@pytest.fixture(scope="module")
def path(trial):
    frames = trial[1]
    t = np.arange(len(frames.values) + 2) * frames.dt_s
    return 0.4 * np.sin(np.outer(t, [3.0, 5.0]))


def test_what_is_expected_is_what_accelerometers_feel(trial, path):
    arm, frames = trial
    at = linearise(frames, instruments_of(arm), path)
    q, dq, ddq = np.empty((3, len(frames.values), arm.n_joint))
    motion_at_knots(path, frames.dt_s, q, dq, ddq)
    felt = specific_force(arm, q, dq, ddq) * np.array([one.scale for one in arm.sensors])
    np.testing.assert_allclose(at.expected, felt.reshape(len(q), -1) + instruments_of(arm).bias, atol=1e-9)
    np.testing.assert_array_equal(at.residual, at.readings - at.expected)


def test_slopes_are_differences(trial, path):
    arm, frames = trial
    here, step, n = linearise(frames, instruments_of(arm), path), 1e-6, arm.n_joint
    for j in range(n):
        moved = path + step * (np.arange(n) == j)  # all coefficients alike: the angle alone moves
        slope = (linearise(frames, instruments_of(arm), moved).expected - here.expected) / step
        np.testing.assert_allclose(here.slope[..., 3 * j], slope, atol=1e-3)


def test_a_base_that_accelerates_is_felt_as_gravity_the_other_way(trial, path):
    arm, frames = trial
    at, a = linearise(frames, instruments_of(arm), path), np.array([0.3, -0.2, 0.1])
    shaken = replace(arm, gravity_m_s2=tuple(np.subtract(arm.gravity_m_s2, a)))
    more = linearise(frames, instruments_of(shaken), path).expected - at.expected
    np.testing.assert_allclose(at.from_base() @ a, more, atol=1e-9)


def test_sensors_not_looked_at_leave_nothing(trial, path):
    arm, frames = trial
    without = np.arange(len(arm.sensors)) == 2
    at = linearise(frames, instruments_of(arm), path, without)
    assert np.all(at.residual[:, 6:9] == 0.0) and np.all(at.weight[:, 6:9] == 0.0)
    assert np.all(at.weight[:, :6] > 0.0)


def test_a_rest_says_that_velocities_are_zero(trial, path):
    arm, frames = trial
    S, r = linearise(frames, instruments_of(arm), path).motion_rows()
    n_channel, rest = 3 * len(arm.sensors), frames.resting
    at_rest = S[:rest, n_channel:]
    assert np.count_nonzero(at_rest) == rest * arm.n_joint and not S[rest:, n_channel:].any()
    np.testing.assert_allclose(
        r[0, n_channel:], -(path[2] - path[0]) / (2.0 * frames.dt_s) * at_rest.max(), rtol=1e-9
    )


def test_a_sensor_that_is_not_turned_turns_by_its_angles(trial):
    plain = replace(trial[0].sensors[0], rotation_rad=(0.0, 0.0, 0.0))
    np.testing.assert_allclose(turn_by_angles(plain), np.eye(3), atol=1e-9)
