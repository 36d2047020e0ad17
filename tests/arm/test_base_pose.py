"""Frame 0 in the world, against homogeneous transforms and scipy's rotations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm
from arm.base_pose import base_in_segment, frame_0_poses, gravity_in_world
from arm.model import Base

ARM = replace(load_arm("dd-arm"), base=Base((0.1, -0.2, 0.3), (0.4, -0.7, 1.2), "pelvis"))


def test_without_a_base_frame_0_is_the_worlds() -> None:
    R, p = base_in_segment(replace(ARM, base=None))
    np.testing.assert_array_equal(R, np.eye(3))
    np.testing.assert_array_equal(p, np.zeros(3))


def test_without_columns_the_base_stands() -> None:
    R, p = frame_0_poses(ARM, None)
    assert R.shape == (1, 3, 3)
    # roll, pitch, yaw about the world's axes, in this order
    np.testing.assert_allclose(R[0], Rotation.from_euler("xyz", [0.4, -0.7, 1.2]).as_matrix(), atol=1e-12)
    assert p.tolist() == [[0.1, -0.2, 0.3]]


def test_the_segments_pose_comes_first() -> None:
    rng = np.random.default_rng(1)
    turns = Rotation.random(5, rng=rng)
    columns = np.hstack([rng.normal(size=(5, 3)), turns.as_quat(scalar_first=True)])
    R, p = frame_0_poses(ARM, columns)
    own = np.eye(4)
    own[:3, :3], own[:3, 3] = Rotation.from_euler("xyz", [0.4, -0.7, 1.2]).as_matrix(), [0.1, -0.2, 0.3]
    for k, turn in enumerate(turns.as_matrix()):
        segment = np.eye(4)
        segment[:3, :3], segment[:3, 3] = turn, columns[k, :3]
        both = segment @ own
        assert R[k] == pytest.approx(both[:3, :3])
        assert p[k] == pytest.approx(both[:3, 3])


def test_gravity_is_in_frame_0_unless_a_segment_carries_the_arm() -> None:
    np.testing.assert_array_equal(gravity_in_world(ARM), ARM.gravity_m_s2)
    assert ARM.base is not None
    turned = Rotation.from_euler("xyz", ARM.base.rotation_rad).apply(ARM.gravity_m_s2)
    np.testing.assert_allclose(gravity_in_world(replace(ARM, base=replace(ARM.base, segment=None))), turned)
    np.testing.assert_array_equal(gravity_in_world(replace(ARM, base=None)), ARM.gravity_m_s2)
