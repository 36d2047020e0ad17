"""What sensors read, against differences of where they are, and against pinocchio."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.accelerometer import specific_force
from arm.kinematics import axis_frames, rotation_from_rpy, sensor_positions
from arm.model import Arm, Joint, Sensor
from limbcal.errors import DataError

FEW = settings(max_examples=30, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)
#: Second derivative by central differences of eighth order.
STENCIL = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])


@FEW
@given(SEEDS, st.booleans())
def test_it_is_acceleration_less_gravity_in_the_sensors_axes(random_arm, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    swing, rate, phase = rng.uniform(0.2, 0.8, (3, arm.n_joint))
    step = 0.01
    t = step * np.arange(-4, 5)[:, None]
    positions = sensor_positions(arm, swing * np.sin(rate * t + phase))
    acceleration = np.einsum("k,ksx->sx", STENCIL, positions) / step**2
    q, dq, ddq = swing * np.sin(phase), swing * rate * np.cos(phase), -swing * rate**2 * np.sin(phase)
    frames = axis_frames(arm, q)[0]
    expected = [
        (frames[sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)).T
        @ (acceleration[s] - arm.gravity_m_s2)
        for s, sensor in enumerate(arm.sensors)
    ]
    np.testing.assert_allclose(specific_force(arm, q, dq, ddq)[0], expected, rtol=0, atol=1e-9)


@FEW
@given(SEEDS, st.booleans())
def test_it_is_pinocchios_classical_acceleration(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = random_motion(arm, rng, 2)
    other = peer(arm)
    frames = [
        other.model.addFrame(
            pin.Frame(
                sensor.name,
                sensor.joint,
                0,
                pin.SE3(rotation_from_rpy(*sensor.rotation_rad), np.array(sensor.position_m)),
                pin.FrameType.SENSOR,
            )
        )
        for sensor in arm.sensors
    ]
    data = other.model.createData()
    force = specific_force(arm, q, dq, ddq)
    for k in range(len(q)):
        pin.forwardKinematics(other.model, data, q[k], dq[k], ddq[k])
        pin.updateFramePlacements(other.model, data)
        for s, frame in enumerate(frames):
            a = pin.getFrameClassicalAcceleration(other.model, data, frame, pin.LOCAL).linear
            a = a - data.oMf[frame].rotation.T @ np.array(arm.gravity_m_s2)
            np.testing.assert_allclose(force[k, s], a, rtol=0, atol=1e-9 * max(1.0, np.abs(a).max()))


@FEW
@given(SEEDS, st.booleans())
def test_at_rest_it_reads_g_upwards(random_arm, seed, branching):
    rng = np.random.default_rng(seed)
    arm = replace(random_arm(rng, branching=branching), gravity_m_s2=(0.0, 0.0, -9.80665))
    q, still = rng.uniform(-np.pi, np.pi, (1, arm.n_joint)), np.zeros((1, arm.n_joint))
    frames, force = axis_frames(arm, q)[0], specific_force(arm, q, still, still)[0]
    for s, sensor in enumerate(arm.sensors):
        to_base = frames[sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
        np.testing.assert_allclose(to_base @ force[s], [0.0, 0.0, 9.80665], rtol=0, atol=1e-12)


def test_on_the_dd_arm_gravity_is_seen_across_the_plane(dd_arm):
    still = np.zeros((1, 2))
    np.testing.assert_array_equal(specific_force(dd_arm, still, still, still)[0], [[0.0, 0.0, 9.80665]] * 4)


def test_a_turning_link_pulls_outwards_by_radius_and_square_of_speed():
    arm = Arm("one", (Joint(),), (0.0, 0.0, 0.0), (Sensor("s", 1, (0.3, 0.0, 0.0)),))
    force = specific_force(arm, np.array([[0.7]]), np.array([[2.0]]), np.array([[5.0]]))
    np.testing.assert_allclose(force[0, 0], [-0.3 * 4.0, 0.3 * 5.0, 0.0], rtol=0, atol=1e-15)


def test_a_sensor_turned_about_its_link_reads_in_its_own_axes():
    arm = Arm("one", (Joint(),), (0.0, -9.0, 0.0), (Sensor("s", 1, rotation_rad=(0.0, 0.0, np.pi / 2)),))
    force = specific_force(arm, np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)))
    np.testing.assert_allclose(force[0, 0], [9.0, 0.0, 0.0], rtol=0, atol=1e-14)


def test_shapes(dd_arm):
    still = np.zeros((3, 2))
    assert specific_force(replace(dd_arm, sensors=()), still, still, still).shape == (3, 0, 3)
    with pytest.raises(DataError, match="dq has 2 samples and q has 3; expected as many"):
        specific_force(dd_arm, still, still[:2], still)
