"""Axes given as lines come back from eq. (1), in any pose."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from arm.axis_lines import AxisLines
from arm.kinematics import axis_frames, tip_position
from arm.model import Arm


def random_lines(seed: int, n: int = 5) -> AxisLines:
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(n, 3))
    points = np.vstack([np.zeros(3), rng.uniform(-0.5, 0.5, (n, 3))])
    return AxisLines(points, directions / np.linalg.norm(directions, axis=1)[:, None], np.array([1.0, 0.0, 0.0]))


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6))
def test_a_chain_turns_about_its_lines_like_a_product_of_exponentials(seed):
    """The independent way: each joint turns all that lies behind it about its line (Brockett 1984)."""
    lines = random_lines(seed)
    arm = Arm("drawn", tuple(lines.joints()))
    q = np.random.default_rng(seed + 1).uniform(-np.pi, np.pi, arm.n_joint)
    turn, place = np.eye(3), np.zeros(3)
    for k, (direction, point) in enumerate(zip(lines.directions, lines.points, strict=False)):
        np.testing.assert_allclose(axis_frames(arm, q)[0, k, :3, 2], turn @ direction, atol=1e-9)
        one = Rotation.from_rotvec(q[k] * direction).as_matrix()
        place = place + turn @ (point - one @ point)
        turn = turn @ one
    np.testing.assert_allclose(tip_position(arm, q)[0], place + turn @ lines.points[-1], atol=1e-9)


def test_axes_that_meet_make_links_of_no_length():
    origin = np.zeros(3)
    lines = AxisLines(np.array([origin, origin, origin, [0.0, 0.0, -0.3]]), np.eye(3), np.array([1.0, 0.0, 0.0]))
    joints = lines.joints()
    assert [joint.a_m for joint in joints] == [0.0, 0.0, 0.0]
    assert [joint.d_m for joint in joints] == [0.0, 0.0, -0.3]
