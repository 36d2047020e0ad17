"""An arm takes over what a state says of its sensors and lengths."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.kinematics import rotation_from_rpy
from arm.model import Gyroscope
from tracking.model.observation import observation_of
from tracking.smoother.calibrated_arm import with_lengths, with_sensors


@pytest.fixture
def sought(dd_arm):
    of, size = observation_of(dd_arm, mountings=True)
    return of, np.zeros(size)


def test_a_state_of_no_departures_leaves_the_sensors(dd_arm, sought):
    found = with_sensors(dd_arm, *sought)
    for one, other in zip(found.sensors, dd_arm.sensors, strict=True):
        np.testing.assert_allclose(one.rotation_rad, other.rotation_rad, atol=1e-12)
        assert (one.position_m, one.scale) == (other.position_m, other.scale)


def test_scale_turn_and_place_are_departures_along_their_own_axes(dd_arm, sought):
    of, x = sought
    first = of.mounting_column[2]
    x[first : first + 9] = [0.01, 0.0, 0.0, 0.0, 0.0, 0.5 * np.pi, 0.0, 0.02, 0.0]
    found, was = with_sensors(dd_arm, of, x).sensors[2], dd_arm.sensors[2]
    assert found.scale == pytest.approx(np.add(was.scale, [0.01, 0.0, 0.0]))
    assert found.position_m == pytest.approx(np.add(was.position_m, [0.0, 0.02, 0.0]))
    quarter = rotation_from_rpy(*was.rotation_rad).T @ rotation_from_rpy(*found.rotation_rad)
    np.testing.assert_allclose(quarter, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], atol=1e-12)


def test_a_gyroscopes_offset_and_scale_are_taken_over(dd_arm):
    first, *others = dd_arm.sensors
    arm = replace(dd_arm, sensors=(replace(first, gyroscope=Gyroscope()), *others))
    of, size = observation_of(arm, mountings=True)
    x, triad = np.zeros(size), len(arm.sensors)
    x[of.gyro_scale_column[triad]] = 0.02
    x[3 * arm.n_joint + 3 * triad + 2] = 0.1
    gyroscope = with_sensors(arm, of, x).sensors[0].gyroscope
    assert gyroscope == Gyroscope((1.02, 1.0, 1.0), (0.0, 0.0, 0.1))


def test_of_lengths_those_that_were_found_change(dd_arm, sought):
    of, x = sought
    column = of.length_column[0][0]
    x[column] = 0.015
    known = SimpleNamespace(final=x, covariance=np.diag(np.full(len(x), 0.002**2)))
    arm = with_lengths(dd_arm, of, known, frozenset({(0, "a_m")}))
    assert arm.joints[0].a_m == pytest.approx(dd_arm.joints[0].a_m + 0.015)
    assert arm.joints[0].length_std_m == pytest.approx(0.002)
    assert arm.joints[1] == dd_arm.joints[1]
