"""The camera sees all of a motion, turns up what is up, and keeps shapes."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import axis_frames
from arm.model import Arm, Joint
from playback.export.camera import FILLED, TILT_DEG, look_at
from playback.export.gravity import upward
from playback.export.sampled import Mover, Sampled, sample
from playback.shape import REAL, base_mesh, link_meshes, link_poses
from tests.playback.export.conftest import source_of

WIDTH, HEIGHT, HEAD = 400, 300, 60


def corners(motion: Sampled) -> np.ndarray:
    """Return all points of the first arm at all instants, and of its base."""
    mover = motion.movers[0]
    poses = link_poses(mover.arm, mover.q)
    places = [base_mesh(mover.arm).vertices]
    for i, mesh in enumerate(link_meshes(mover.arm)):
        places.append((poses[:, i, None, :3, :3] @ mesh.vertices[:, :, None])[..., 0] + poses[:, i, None, :3, 3])
    return np.concatenate([place.reshape(-1, 3) for place in places])


def test_all_of_it_is_seen_and_not_too_small(motion: Sampled) -> None:
    camera = look_at(motion.movers, WIDTH, HEIGHT, HEAD)
    seen = camera.project(corners(motion))[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    assert np.all(low >= [0.0, HEAD]) and np.all(high <= [WIDTH, HEIGHT])
    share = (high - low) / [WIDTH, HEIGHT - HEAD]
    assert 0.7 * FILLED < share.max() <= FILLED + 1e-9
    assert 0.5 * (low + high) == pytest.approx([WIDTH / 2, (HEIGHT + HEAD) / 2], abs=0.12 * WIDTH)


def test_it_is_a_rotation_and_up_is_up(motion: Sampled) -> None:
    camera = look_at(motion.movers, WIDTH, HEIGHT)
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(camera.axes) == pytest.approx(1.0)
    up = upward(motion.movers[0].arm)
    along = camera.axes @ up
    assert along[0] == pytest.approx(0.0, abs=1e-9)  # up leans neither right nor left
    assert along[1] > 0.0


def test_pixels_are_scaled_metres_with_down_counted_down(motion: Sampled) -> None:
    camera = look_at(motion.movers, WIDTH, HEIGHT)
    origin = camera.project(np.zeros((1, 3)))[0]
    for k, step in enumerate(([1.0, 0.0], [0.0, -1.0])):
        moved = camera.project(camera.axes[k][None])[0]
        assert (moved - origin)[:2] == pytest.approx(camera.scale * np.array(step), abs=1e-9)
    assert camera.project(camera.axes[2][None])[0, 2] - origin[2] == pytest.approx(camera.scale)


def test_a_planar_arm_is_seen_along_its_axis_a_little_tilted(pair: Sampled) -> None:
    camera = look_at(pair.movers, WIDTH, HEIGHT)
    assert camera.axes[2, 2] == pytest.approx(np.cos(np.radians(TILT_DEG)))


@pytest.mark.parametrize("turn_rad", [0.0, np.pi / 2.0, -np.pi / 2.0])
def test_it_is_so_also_where_gravity_pulls_along_the_axis(turn_rad: float) -> None:
    arm = Arm("flat", (Joint(alpha_rad=turn_rad, a_m=0.0), Joint(a_m=0.3)))
    axis = axis_frames(arm, np.zeros((1, 2)))[0, 0, :3, 2]
    arm = replace(arm, gravity_m_s2=tuple(-9.81 * axis))
    camera = look_at(sample(source_of(arm), None, 60.0, 1.0).movers, WIDTH, HEIGHT)
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert abs(camera.axes[2] @ axis) == pytest.approx(np.cos(np.radians(TILT_DEG)))
    assert camera.axes[0] @ axis == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("turns", [(0.0, 0.0), (0.0, np.pi), (np.pi, 0.0), (np.pi, np.pi)])
def test_it_is_looked_at_from_above_whichever_way_its_axes_point(turns: tuple[float, float]) -> None:
    one, other = turns
    arm = Arm("flat", (Joint(alpha_rad=one, a_m=0.3), Joint(alpha_rad=other, a_m=0.2)))
    camera = look_at(sample(source_of(arm), None, 60.0, 1.0).movers, WIDTH, HEIGHT)
    assert camera.axes[2, 2] == pytest.approx(np.cos(np.radians(TILT_DEG)))


def test_an_arm_that_leans_is_seen_from_the_side_and_above() -> None:
    arm = replace(load_arm("spatial-arm"), gravity_m_s2=(3.0, -5.0, -6.0))
    camera = look_at(sample(source_of(arm), None, 60.0, 1.0).movers, WIDTH, HEIGHT)
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    right, upwards, nearer = camera.axes @ upward(arm)
    assert right == pytest.approx(0.0, abs=1e-9)
    assert 0.8 < upwards < 1.0 and 0.2 < nearer < 0.6


def test_the_floor_is_under_the_base(motion: Sampled) -> None:
    camera = look_at(motion.movers, WIDTH, HEIGHT)
    one, other, place = camera.floor
    normal = np.cross(one, other)
    assert np.linalg.norm(normal) == pytest.approx(1.0)
    assert one @ other == pytest.approx(0.0, abs=1e-12)
    assert one == pytest.approx(camera.axes[0])  # to the right
    assert abs(normal @ camera.axes[2]) > 0.3  # and never seen from its edge
    heights = (base_mesh(motion.movers[0].arm).vertices - place) @ (normal * np.sign(normal @ place or 1.0))
    assert min(abs(heights.min()), abs(heights.max())) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("stretched", [0, 1, 2])
def test_a_moment_s_reach_is_in_the_picture(stretched: int) -> None:
    """Folded it needs hardly any room, but for one instant."""
    arm = Arm("folding", (Joint(a_m=0.5), Joint(a_m=0.5)))
    q = np.tile([0.0, np.pi], (3, 1))
    q[stretched] = 0.0
    mover = Mover("folding", arm, q, 0 * q, 0 * q, REAL)
    camera = look_at((mover,), WIDTH, HEIGHT)
    right, down, _ = camera.project(np.array([1.0, 0.0, 0.0]))
    assert 0.0 < right < WIDTH and 0.0 < down < HEIGHT
