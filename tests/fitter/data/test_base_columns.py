"""How frame 0 moves, from the pose of the segment that carries the base."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm
from arm.model import Base
from fitter.data.base_columns import LEAST_SAMPLES, base_state, derivatives
from limbcal.errors import DataError

T = np.linspace(0.0, 2.0, 401)
PLACE, TURN = (0.3, -0.2, 0.5), (0.4, -0.7, 1.1)
LEANING = Rotation.from_euler("x", 0.8)
#: What a spline through 200 samples a second leaves of a motion of a hertz, away from its ends.
INNER = slice(20, -20)


def poses(t):
    """Return rotation and place of a segment that yaws, pitches, leans aside and is carried about."""
    yaw, pitch = 2.0 * np.sin(1.5 * t), 1.2 * np.sin(2.0 * t + 0.3)
    place = np.column_stack([0.5 * np.sin(3.0 * t), 0.2 * t**2, np.cos(2.0 * t)])
    return Rotation.from_euler("ZY", np.column_stack([yaw, pitch])) * LEANING, place


def columns_of(t):
    rotation, place = poses(t)
    return np.column_stack([place, rotation.as_quat()[:, [3, 0, 1, 2]]])


def turn_rate(t):
    """Return the angular velocity in the world: yaw about z, pitch about the yawed y."""
    yaw, dyaw, dpitch = 2.0 * np.sin(1.5 * t), 3.0 * np.cos(1.5 * t), 2.4 * np.cos(2.0 * t + 0.3)
    return np.column_stack([-np.sin(yaw) * dpitch, np.cos(yaw) * dpitch, dyaw])


@pytest.fixture(scope="module")
def arm():
    return replace(load_arm("dd-arm"), base=Base(PLACE, TURN))


def frame_0(t):
    """Return where frame 0 is, by the chain of the two poses."""
    rotation, place = poses(t)
    return (rotation * Rotation.from_euler("xyz", TURN)).as_matrix(), place + rotation.apply(PLACE)


def test_frame_0_moves_as_the_segment_carries_it(arm):
    state = base_state(arm, T, columns_of(T), "run.csv")
    R, p = frame_0(T)
    np.testing.assert_allclose(state.R, R, rtol=0, atol=1e-9)
    np.testing.assert_allclose(state.p, p, rtol=0, atol=1e-9)
    h = 1e-4
    (_, before), (_, after) = frame_0(T - h), frame_0(T + h)
    acceleration = (before - 2.0 * p + after) / h**2
    swing = (turn_rate(T + h) - turn_rate(T - h)) / (2.0 * h)
    for found, expected in (
        (state.omega, turn_rate(T)),
        (state.omega_dot, swing),
        (state.acceleration, acceleration),
    ):
        np.testing.assert_allclose(found[INNER], expected[INNER], rtol=0, atol=1e-4)


def test_a_quaternion_and_its_negative_are_one_turn(arm):
    columns = columns_of(T)
    flipped = columns.copy()
    flipped[50:120, 3:] *= -1.0
    flipped[300:, 3:] *= -1.0
    expected, found = (base_state(arm, T, one, "run.csv") for one in (columns, flipped))
    for name in ("R", "omega", "omega_dot", "acceleration"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), rtol=0, atol=1e-9)


def test_where_no_base_is_given_the_segment_is_frame_0():
    state = base_state(load_arm("dd-arm"), T, columns_of(T), "run.csv")
    rotation, place = poses(T)
    np.testing.assert_allclose(state.R, rotation.as_matrix(), rtol=0, atol=1e-9)
    np.testing.assert_array_equal(state.p, place)


def test_without_columns_the_base_stands_where_the_file_has_it(arm):
    state = base_state(arm, T, None, "run.csv")
    turn = Rotation.from_euler("xyz", TURN).as_matrix()
    np.testing.assert_allclose(state.R, np.tile(turn, (len(T), 1, 1)), rtol=0, atol=1e-12)
    np.testing.assert_array_equal(state.p, np.tile(PLACE, (len(T), 1)))
    for moved in (state.omega, state.omega_dot, state.acceleration):
        np.testing.assert_array_equal(moved, np.zeros((len(T), 3)))


def test_a_quaternion_s_length_is_rounded_or_wrong(arm):
    columns = columns_of(T)
    columns[:, 3:] *= 1.0009
    exact, rounded = (base_state(arm, T, one, "run.csv") for one in (columns_of(T), columns))
    np.testing.assert_allclose(rounded.R, exact.R, rtol=0, atol=1e-9)
    np.testing.assert_allclose(rounded.omega, exact.omega, rtol=0, atol=1e-9)
    for factor in (0.998, 1.002):
        wrong = columns_of(T)
        wrong[7, 3:] *= factor
        with pytest.raises(DataError, match=rf"run.csv: .* has length {factor} in row 8, expected 1"):
            base_state(arm, T, wrong, "run.csv")


def test_derivatives_of_a_quintic_are_its_own():
    t = np.array([0.0, 0.1, 0.3, 0.4, 0.6, 0.7, 1.0])
    first, second = derivatives(t, np.column_stack([t**5, t**2]))
    np.testing.assert_allclose(first, np.column_stack([5.0 * t**4, 2.0 * t]), rtol=0, atol=1e-9)
    np.testing.assert_allclose(second, np.column_stack([20.0 * t**3, 2.0 + 0.0 * t]), rtol=0, atol=1e-8)


def test_too_few_samples_are_not_differentiated():
    t = np.arange(float(LEAST_SAMPLES))
    assert derivatives(t, t[:, None])[0] == pytest.approx(1.0)
    with pytest.raises(DataError, match="a trial has 5 samples, expected at least 6 to differentiate"):
        derivatives(t[:5], t[:5, None])
