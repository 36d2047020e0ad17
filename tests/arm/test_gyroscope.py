"""What ideal gyroscopes read, against how their axes turn."""

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.gyroscope import angular_velocity
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Gyroscope

STEP_S = 1e-5


@pytest.mark.parametrize("name", ["dd-arm", "spatial-arm"])
def test_a_gyroscope_reads_how_its_axes_turn(name: str) -> None:
    """The rate of a rotation matrix is ``R [omega]``, omega in the turning axes: R^T dR/dt is the cross matrix."""
    arm = load_arm(name)
    arm = arm.with_gyroscopes([sensor.name for sensor in arm.sensors[1:]])
    rng = np.random.default_rng(0)
    q, dq = rng.normal(size=(2, 5, arm.n_joint))
    found = angular_velocity(arm, q, dq)
    assert found.shape == (5, len(arm.sensors[1:]), 3)
    later, before = (axis_frames(arm, q + sign * STEP_S * dq)[..., :3, :3] for sign in (1.0, -1.0))
    for k, sensor in enumerate(arm.sensors[1:]):
        turned = rotation_from_rpy(*sensor.rotation_rad)
        R = axis_frames(arm, q)[:, sensor.joint - 1, :3, :3] @ turned
        rate = (later - before)[:, sensor.joint - 1] @ turned / (2.0 * STEP_S)
        cross = np.swapaxes(R, 1, 2) @ rate
        expected = np.stack([cross[:, 2, 1], cross[:, 0, 2], cross[:, 1, 0]], axis=1)
        np.testing.assert_allclose(found[:, k], expected, atol=1e-6)


def test_channels_are_those_of_all_accelerometers_and_then_of_the_gyroscopes() -> None:
    arm = load_arm("dd-arm").with_gyroscopes(["s3", "s1"])
    assert arm.n_channel == 18 == len(arm.channels)
    assert arm.channels[:4] == ("s1x", "s1y", "s1z", "s2x")
    assert arm.channels[12:] == ("s1gx", "s1gy", "s1gz", "s3gx", "s3gy", "s3gz")
    assert arm.with_gyroscopes(()).channels == load_arm("dd-arm").channels


def test_a_gyroscope_stands_in_the_arm_file() -> None:
    text = format_arm(load_arm("dd-arm").with_gyroscopes(["s2"]))
    assert parse_arm(text, "arm.toml").gyroscopes == (1,)
    known = parse_arm(
        text.replace("gyroscope = { scale = [1.0, 1.0, 1.0]", "gyroscope = { scale = [1.01, 1.0, 0.99]"), "x"
    )
    assert known.sensors[1].gyroscope == Gyroscope((1.01, 1.0, 0.99))
    assert parse_arm(format_arm(known), "x").sensors == known.sensors
