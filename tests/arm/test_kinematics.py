"""Eq. (1) as five factors and as printed, eq. (2) and (3) against pinocchio."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.kinematics import (
    axis_frames,
    link_transforms,
    rotation_from_rpy,
    rpy_from_rotation,
    sensor_positions,
    tip_position,
)
from arm.model import Arm, Joint, Sensor
from limbcal.errors import DataError

ANGLE = st.floats(-2 * np.pi, 2 * np.pi)
LENGTH = st.floats(-2.0, 2.0)
FEW = settings(max_examples=40, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


def five_factors(alpha, a, d, beta, theta):
    """Return Rot(y, beta) Rot(x, alpha) Trans(0, 0, d) Rot(z, theta) Trans(a, 0, 0), factor by factor."""
    ca, sa, cb, sb, ct, s = (f(x) for x in (alpha, beta, theta) for f in (np.cos, np.sin))
    rot_y = np.array([[cb, 0, sb, 0], [0, 1, 0, 0], [-sb, 0, cb, 0], [0, 0, 0, 1]])
    rot_x = np.array([[1, 0, 0, 0], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])
    trans_d = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
    rot_z = np.array([[ct, -s, 0, 0], [s, ct, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    trans_a = np.array([[1, 0, 0, a], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    return rot_y @ rot_x @ trans_d @ rot_z @ trans_a


def as_printed(alpha, a, d, beta, theta):
    """Return the last form of eq. (1), entry by entry."""
    ca, sa, cb, sb, c, s = (f(x) for x in (alpha, beta, theta) for f in (np.cos, np.sin))
    return np.array(
        [
            [cb * c + sa * sb * s, c * sa * sb - cb * s, ca * sb, d * ca * sb + a * (cb * c + sa * sb * s)],
            [ca * s, ca * c, -sa, -d * sa + a * ca * s],
            [-c * sb + cb * sa * s, cb * c * sa + sb * s, ca * cb, d * ca * cb + a * (-c * sb + cb * sa * s)],
            [0, 0, 0, 1],
        ]
    )


@FEW
@given(ANGLE, LENGTH, LENGTH, ANGLE, ANGLE, ANGLE)
def test_eq_1_is_the_product_of_its_five_factors(alpha, a, d, beta, offset, q):
    turning = Arm("one", (Joint("revolute", alpha, a, d, beta, offset),))
    sliding = Arm("one", (Joint("prismatic", alpha, a, d, beta, offset),))
    T = link_transforms(turning, np.array([[q]]))[0, 0]
    np.testing.assert_allclose(T, five_factors(alpha, a, d, beta, offset + q), rtol=0, atol=1e-12)
    np.testing.assert_allclose(T, as_printed(alpha, a, d, beta, offset + q), rtol=0, atol=1e-12)
    T = link_transforms(sliding, np.array([[q]]))[0, 0]
    np.testing.assert_allclose(T, five_factors(alpha, a, d + q, beta, offset), rtol=0, atol=1e-12)


@FEW
@given(SEEDS)
def test_eq_2_is_the_product_over_the_links(random_arm, random_motion, seed):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng)
    q, _, _ = random_motion(arm, rng)
    T = link_transforms(arm, q)
    for k in range(len(q)):
        product = np.eye(4)
        for i, joint in enumerate(arm.joints):
            turn, slide = (q[k, i], 0.0) if joint.type == "revolute" else (0.0, q[k, i])
            product = product @ five_factors(
                joint.alpha_rad, joint.a_m, joint.d_m + slide, joint.beta_rad, joint.theta_offset_rad + turn
            )
            np.testing.assert_allclose(T[k, i], product, rtol=0, atol=1e-12)


@FEW
@given(SEEDS, st.booleans())
def test_frames_tip_and_sensors_are_where_pinocchio_has_them(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, _, _ = random_motion(arm, rng)
    other = peer(arm)
    frames, tips, sensors = axis_frames(arm, q), tip_position(arm, q), sensor_positions(arm, q)
    for k in range(len(q)):
        pin.framesForwardKinematics(other.model, other.data, q[k])
        for i in range(arm.n_joint):
            np.testing.assert_allclose(frames[k, i], other.data.oMi[i + 1].homogeneous, rtol=0, atol=1e-9)
        np.testing.assert_allclose(tips[k], other.data.oMf[other.tip].translation, rtol=0, atol=1e-9)
        for s, sensor in enumerate(arm.sensors):
            place = other.data.oMi[sensor.joint].act(np.array(sensor.position_m))
            np.testing.assert_allclose(sensors[k, s], place, rtol=0, atol=1e-9)


@FEW
@given(ANGLE, ANGLE, ANGLE)
def test_roll_pitch_yaw_turn_as_elsewhere(roll, pitch, yaw):
    R = rotation_from_rpy(roll, pitch, yaw)
    np.testing.assert_allclose(R, pin.rpy.rpyToMatrix(roll, pitch, yaw), rtol=0, atol=1e-12)


@FEW
@given(st.floats(-np.pi, np.pi), st.floats(-np.pi / 2, np.pi / 2), st.floats(-np.pi, np.pi))
def test_roll_pitch_yaw_are_found_again(roll, pitch, yaw):
    found = rpy_from_rotation(rotation_from_rpy(roll, pitch, yaw))
    assert found.shape == (3,) and abs(found[1]) <= np.pi / 2
    np.testing.assert_allclose(rotation_from_rpy(*found), rotation_from_rpy(roll, pitch, yaw), rtol=0, atol=1e-7)
    if abs(pitch) < 1.5:  # away from the pole there is only one answer
        expected = np.array([roll, pitch, yaw])
        np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * expected), rtol=0, atol=1e-8)


@FEW
@given(ANGLE, st.floats(np.pi / 2 - 1e-7, np.pi / 2 + 1e-7), ANGLE, st.sampled_from([1.0, -1.0]))
def test_straight_up_and_down_roll_takes_it_all(roll, pitch, yaw, sign):
    """At a pitch of 90 degrees, and as near to it as numbers go, the turn is still the same."""
    rotation = rotation_from_rpy(roll, sign * pitch, yaw)
    np.testing.assert_allclose(rotation_from_rpy(*rpy_from_rotation(rotation)), rotation, rtol=0, atol=1e-7)
    exactly = rotation_from_rpy(roll, sign * np.pi / 2, yaw)
    assert rpy_from_rotation(exactly)[2] == 0.0


def test_dd_arm_lies_in_its_plane(dd_arm):
    q = np.array([[0.3, 0.4]])
    expected = [0.25 * np.cos(0.3) + 0.3 * np.cos(0.7), 0.25 * np.sin(0.3) + 0.3 * np.sin(0.7), 0.0]
    np.testing.assert_allclose(tip_position(dd_arm, q)[0], expected, rtol=0, atol=1e-15)


def test_one_row_may_come_alone_and_none_may_come(dd_arm):
    np.testing.assert_array_equal(tip_position(dd_arm, np.array([0.1, 0.2])), tip_position(dd_arm, [[0.1, 0.2]]))
    assert tip_position(dd_arm, np.empty((0, 2))).shape == (0, 3)
    assert sensor_positions(dd_arm, np.zeros((7, 2))).shape == (7, 4, 3)


def test_an_arm_without_sensors_has_no_positions():
    assert sensor_positions(Arm("bare", (Joint(),)), np.zeros((3, 1))).shape == (3, 0, 3)


def test_a_sensor_is_placed_in_its_joint_axis_frame():
    arm = Arm("one", (Joint(a_m=0.5),), sensors=(Sensor("s", 1, (0.2, 0.1, 0.0)),))
    place = sensor_positions(arm, np.array([[np.pi / 2]]))[0, 0]
    np.testing.assert_allclose(place, [-0.1, 0.2, 0.0], rtol=0, atol=1e-15)


@pytest.mark.parametrize("function", [link_transforms, axis_frames, tip_position, sensor_positions])
def test_wrong_number_of_joints_is_named(dd_arm, function):
    with pytest.raises(DataError, match=r"q has shape \(4, 3\), expected \(n_sample, 2\)"):
        function(dd_arm, np.zeros((4, 3)))


@pytest.mark.parametrize("noise_deg", [0.0, 15.0])
def test_noise_in_the_angles_shrinks_the_lengths_of_a_plain_fit(dd_arm, noise_deg):
    """The mean of cos(q + e) is exp(-s^2 / 2) cos q: 3.4 % off a1 at 15 degrees, 6.6 % off a2, with two noises."""
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (400_000, 2))
    tip = tip_position(dd_arm, q)[:, :2].ravel()
    seen = np.cumsum(q + np.deg2rad(noise_deg) * rng.standard_normal(q.shape), axis=1)
    columns = np.stack([np.cos(seen), np.sin(seen)], axis=1).reshape(-1, 2)
    found = np.linalg.lstsq(columns, tip)[0]
    shrunk = np.exp(-(np.deg2rad(noise_deg) ** 2) * np.array([1.0, 2.0]) / 2)
    np.testing.assert_allclose(found / [0.25, 0.3], shrunk, rtol=2e-3)
