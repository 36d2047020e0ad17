"""Sensors that are late or loose: slopes against readings that are made so, information against the dense one."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.kinematics import rotation_from_rpy
from arm.model import Arm
from tests.tracking.smoother.test_smoothing_pass import N, Problem
from tracking.model.clocks import CLOCK_STD_S
from tracking.smoother.linearised import Linearised
from tracking.smoother.sensor_effects import PLAY_STD_RAD, SensorEffects, information_of, late_and_loose
from tracking.smoother.smoothing_pass import Pass


def linearised(arm: Arm, case: str) -> Linearised:
    """Return a small problem."""
    one = Problem(arm, case)
    return Linearised(one.of, one.course, one.at, one.x0, one.P0)


def swinging(arm: Arm, case: str) -> tuple[Linearised, Pass, np.ndarray]:
    """Return a problem whose readings are those of an arm that swings, that motion as a pass, and its angles."""
    problem, t, n = linearised(arm, case), 0.01 * np.arange(N), arm.n_joint
    q = 0.5 * np.sin(np.outer(t, 3.0 + np.arange(n)))
    dq, ddq = np.gradient(q, t, axis=0), np.zeros_like(q)
    readings = specific_force(arm, q, dq, ddq).reshape(N, -1)
    found = problem.smoothed()[0]
    states, variance = found.states.copy(), np.zeros_like(found.variance)
    states[:, 1 : 3 * n : 3] = dq
    course = problem.course._replace(readings=readings, present=np.ones(N, dtype=bool))
    return problem._replace(course=course), found._replace(states=states, variance=variance), q


def turned(arm: Arm, q: np.ndarray, dq: np.ndarray, psi: float) -> np.ndarray:
    """Return readings of the last sensor (N, 3) if it is turned by psi to the side from which its joint turns."""
    sensor, readings = arm.sensors[-1], np.empty((len(q), 3))
    for k, side in enumerate(np.sign(dq[:, sensor.joint - 1])):
        R = rotation_from_rpy(0.0, 0.0, psi * side) @ rotation_from_rpy(*sensor.rotation_rad)
        felt = specific_force(arm, q[k : k + 1], dq[k : k + 1], 0.0 * q[k : k + 1]).reshape(-1, 3)[-1]
        readings[k] = R.T @ rotation_from_rpy(*sensor.rotation_rad) @ felt
    return readings


def test_a_play_turns_its_sensor_to_the_side_from_which_the_joint_turns(vertical_arm: Arm) -> None:
    problem, found, q = swinging(vertical_arm, "plain")
    dq, psi = found.states[:, 1:6:3], 1e-6
    effects = late_and_loose(problem, found, np.arange(4), (1, 3))
    assert effects.slopes.shape == (2 + 4, N, 12)
    np.testing.assert_array_equal(effects.prior_std, [CLOCK_STD_S] * 2 + [PLAY_STD_RAD] * 4)
    differences = (turned(vertical_arm, q, dq, psi) - turned(vertical_arm, q, dq, 0.0)) / psi
    np.testing.assert_allclose(effects.slopes[-1, :, 9:], differences, atol=1e-4)
    assert not effects.slopes[-1, :, :9].any()


def test_a_side_is_known_as_well_as_the_speed(vertical_arm: Arm) -> None:
    """Its mean is twice the probability that the joint turns that way, less one."""
    problem, found, _ = swinging(vertical_arm, "plain")
    sure = late_and_loose(problem, found, np.arange(4), ()).slopes[-1]
    variance = found.variance.copy()
    variance[:, 4] = found.states[:, 4] ** 2  # a standard deviation from rest: 84.13 %
    unsure = late_and_loose(problem, found._replace(variance=variance), np.arange(4), ()).slopes[-1]
    np.testing.assert_allclose(unsure, (2.0 * 0.8413447460685429 - 1.0) * sure, rtol=1e-9)


def test_late_readings_are_less_by_their_rates(vertical_arm: Arm) -> None:
    problem, found, _ = swinging(vertical_arm, "plain")
    late = late_and_loose(problem, found, np.arange(4), (1, 3)).slopes[:2]
    rate = np.gradient(problem.course.readings, 0.01, axis=0)
    middle = slice(6, -6)
    np.testing.assert_allclose(late[1, middle, 9:], -rate[middle, 9:], atol=0.02 * np.abs(rate).max())
    assert not late[1, :, :9].any() and not late[0, :, [0, 1, 2, *range(6, 12)]].any()


def test_ac_coupled_sensors_and_those_on_links_that_slide_have_no_play(vertical_arm: Arm) -> None:
    sliding = replace(vertical_arm.joints[1], type="prismatic")
    arm = replace(vertical_arm, joints=(vertical_arm.joints[0], sliding))
    problem, found, _ = swinging(arm, "plain")
    assert len(late_and_loose(problem, found, np.arange(4), ()).slopes) == 2
    coupled = linearised(vertical_arm, "AC-coupled, sought")
    corners = int(np.count_nonzero(coupled.of.corner))
    assert corners and len(late_and_loose(coupled, coupled.smoothed()[0], np.arange(4), ()).slopes) == 4 - corners


@pytest.mark.parametrize("case", ["plain", "discrepancy"])
def test_information_is_that_of_one_more_constant(vertical_arm: Arm, case: str) -> None:
    """An offset of a channel is an effect whose slope is 1; its prior and what readings say add up."""
    problem = linearised(vertical_arm, case)
    problem = problem._replace(course=problem.course._replace(wander=0.0 * problem.course.wander))
    offset, std = 3 * problem.n_joint, 0.05
    P0 = problem.P0.copy()
    P0[offset, :], P0[:, offset] = 0.0, 0.0
    known = problem._replace(P0=P0)
    slopes = np.zeros((1, *problem.course.readings.shape))
    slopes[0, :, 0] = 1.0
    found = known.smoothed()[0]
    information = information_of(known, found, SensorEffects(slopes, np.array([std])))
    P0 = P0.copy()
    P0[offset, offset] = std**2
    covariance = problem._replace(P0=P0).smoothed()[2]
    assert information[0, 0] + std**-2 == pytest.approx(1.0 / covariance[offset, offset], rel=1e-6)
