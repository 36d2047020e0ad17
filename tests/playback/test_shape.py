"""The arm as meshes: closed, outward, and where the joints are."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.kinematics import link_transforms, sensor_positions
from arm.model import Arm, Joint, Sensor, Tip
from playback.shape import Mesh, base_mesh, link_meshes, link_poses, reach_m, sensor_mesh

ARMS = ("dd-arm", "dd-arm-vertical", "spatial-arm", "human-arm-right", "human-leg-left", "examples/human-arm.toml")


@pytest.fixture(params=ARMS)
def arm(request: pytest.FixtureRequest) -> Arm:
    return load_arm(request.param)


def meshes_of(arm: Arm) -> list[Mesh]:
    return [base_mesh(arm), *link_meshes(arm), *(sensor_mesh(arm, sensor) for sensor in arm.sensors)]


def check_solid(mesh: Mesh) -> None:
    """Every shell of it is closed, and turned outward."""
    assert np.isfinite(mesh.vertices).all() and mesh.faces.dtype.kind == "i"
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert surface.is_watertight and surface.is_winding_consistent
    for shell in surface.split(only_watertight=False):
        assert shell.volume > 0.0
        assert shell.euler_number == 2


def test_meshes_are_closed_and_outward(arm: Arm) -> None:
    meshes = meshes_of(arm)
    assert len(meshes) == 1 + arm.n_joint + len(arm.sensors)
    for mesh in meshes:
        check_solid(mesh)


finite = st.floats(-1.0, 1.0).map(lambda x: round(x, 3))
joints = st.builds(
    Joint,
    type=st.sampled_from(["revolute", "prismatic"]),
    a_m=st.one_of(st.just(0.0), finite),
    d_m=st.one_of(st.just(0.0), finite),
    alpha_rad=finite,
    beta_rad=finite,
)


@settings(deadline=None, max_examples=20)
@given(st.lists(joints, min_size=1, max_size=7), st.tuples(finite, finite, finite))
def test_any_chain_is_drawn_solid_and_no_larger_than_its_reach_allows(
    chain: list[Joint], place: tuple[float, float, float]
) -> None:
    arm = Arm("any", tuple(chain), sensors=(Sensor("s1", len(chain), place),))
    reach = reach_m(arm)
    assert reach > 0.0
    for mesh in meshes_of(arm):
        check_solid(mesh)
        assert np.abs(mesh.vertices).max() <= 2.0 * reach + np.linalg.norm(place) + 1e-9


def test_every_link_reaches_from_its_axis_to_the_next(arm: Arm) -> None:
    """The arm looks connected: both ends of a link are inside its mesh, and so is the axis of the next."""
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (1, arm.n_joint))
    poses = link_poses(arm, q)[0]
    for i, mesh in enumerate(link_meshes(arm)):
        surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        near_end, far_end = np.zeros(3), np.array([arm.joints[i].a_m, 0.0, 0.0])
        points = [near_end, far_end]
        if i + 1 < arm.n_joint:
            points.append(np.linalg.solve(poses[i], poses[i + 1][:, 3])[:3])
        for point in points:
            assert min(shell_distance(shell, point) for shell in surface.split()) < 0.02 * reach_m(arm)
    assert np.allclose(link_transforms(arm, q)[0, :, :3, :3], poses[:, :3, :3])


def shell_distance(shell: trimesh.Trimesh, point: np.ndarray) -> float:
    """Distance to a convex shell: 0 inside."""
    normals, corners = shell.face_normals, shell.triangles[:, 0]
    return float(max(0.0, np.max(np.sum(normals * (point - corners), axis=1))))


def test_sensors_are_where_they_ride(arm: Arm) -> None:
    q = np.full((1, arm.n_joint), 0.3)
    poses, places = link_poses(arm, q)[0], sensor_positions(arm, q)[0]
    for sensor, place in zip(arm.sensors, places, strict=True):
        centre = sensor_mesh(arm, sensor).vertices.mean(axis=0)
        T = poses[sensor.joint - 1]
        assert T[:3, :3] @ centre + T[:3, 3] == pytest.approx(place, abs=1e-12)


def test_size_goes_with_the_reach() -> None:
    arm = load_arm("dd-arm")
    assert reach_m(arm) == pytest.approx(0.55)
    large = replace(arm, sensors=()).with_joints(a_m=np.array([2.5, 3.0]))
    small = replace(arm, sensors=())
    for ten_times, mesh in zip(link_meshes(large), link_meshes(small), strict=True):
        assert ten_times.vertices == pytest.approx(10.0 * mesh.vertices)


def test_a_last_link_of_no_length_reaches_to_what_rides_on_it() -> None:
    arm = load_arm("examples/human-arm.toml")
    wrist = np.array(arm.sensors[-1].position_m) + np.array(arm.tip.offset_m if arm.tip else 0.0)
    hand = link_meshes(arm)[-1].vertices
    assert np.min(np.linalg.norm(hand - wrist, axis=1)) < 0.05 * reach_m(arm)


def test_a_tip_off_its_sensor_is_where_the_last_link_ends() -> None:
    arm = load_arm("examples/human-arm.toml")
    sensor = arm.sensors[-1]
    off = replace(arm, tip=Tip(sensor.name, (0.1, 0.0, 0.2)))
    end = np.array(sensor.position_m) + np.array([0.1, 0.0, 0.2])
    assert np.min(np.linalg.norm(link_meshes(off)[-1].vertices - end, axis=1)) < 0.05 * reach_m(off)


def test_a_last_link_of_no_length_with_nothing_on_it_is_only_a_hub() -> None:
    arm = Arm("wrist", (Joint(a_m=0.3), Joint(alpha_rad=1.0)))
    hub = link_meshes(arm)[1].vertices
    assert np.linalg.norm(hub, axis=1).max() < 0.1 * reach_m(arm)


def shells(mesh: Mesh) -> list[trimesh.Trimesh]:
    return list(trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).split())


STRAIGHT = Arm("straight", (Joint(a_m=0.4), Joint(a_m=0.3), Joint(a_m=0.3)))  # a metre in all


@pytest.mark.parametrize("d_m", [0.0, 0.3, -0.3])
def test_an_arm_stands_on_a_plate_at_the_far_side_of_its_axis(d_m: float) -> None:
    arm = Arm("post", (Joint(a_m=0.5, d_m=d_m), Joint(a_m=0.5 - abs(d_m))))
    plate, foot, *post = shells(base_mesh(arm))
    hub = float(shells(link_meshes(arm)[0])[0].bounds[1][0])
    side = 1.0 if d_m < 0.0 else -1.0
    low, high = sorted((side * plate.bounds[:, 2]).tolist())
    assert 1.5 * hub < plate.bounds[1][0] < 2.5 * hub and 0.3 * hub < high - low < 0.7 * hub
    assert sorted((side * foot.bounds[:, 2]).tolist()) == pytest.approx([0.0, low])  # from the axis to the plate
    assert hub < foot.bounds[1][0] < 1.3 * hub and 0.8 * hub < low < 1.2 * hub
    rim = np.linalg.norm(plate.vertices[np.isclose(side * plate.vertices[:, 2], high)][:, :2], axis=1).max()
    assert 0.9 < rim / plate.bounds[1][0] < 0.99
    ends = np.sort([one.bounds[:, 2] for one in post]).ravel().tolist()
    radius = float(post[0].bounds[1][0]) if post else 0.0
    assert ends == pytest.approx(sorted([-np.sign(d_m) * radius, d_m + np.sign(d_m) * radius]) if d_m else [])
    assert not post or 0.35 * hub < radius < 0.65 * hub


@pytest.mark.parametrize("d_m", [0.0, 0.2, -0.2])
def test_what_slides_has_a_rail_of_half_a_reach_to_either_side(d_m: float) -> None:
    arm = Arm("rail", (Joint(a_m=0.3), Joint("prismatic", a_m=0.7 - abs(d_m), d_m=d_m, alpha_rad=np.pi / 2.0)))
    mesh, carried = link_meshes(arm)
    hub, beam, rail = shells(mesh)
    low, high = min(0.0, d_m) - 0.5, max(0.0, d_m) + 0.5
    assert rail.bounds[:, 1].tolist() == pytest.approx([-high, -low])  # its axis is turned to -y
    assert rail.bounds[:, 0] - 0.3 == pytest.approx(-(rail.bounds[::-1, 0] - 0.3))
    carriage = shells(carried)[0]
    assert 0.3 < rail.extents[0] / carriage.extents[0] < 0.5 and rail.extents[0] == pytest.approx(rail.extents[2])
    assert carriage.extents[0] == pytest.approx(carriage.extents[1])
    assert 1.1 < carriage.extents[2] / carriage.extents[0] < 1.5


@pytest.mark.parametrize(
    ("place", "foot"),
    [
        ((0.2, 0.15, 0.0), (0.2, 0.0, 0.0)),  # beside the beam
        ((0.5, 0.0, -0.2), (0.4, 0.0, 0.0)),  # beyond its end
        ((-0.2, 0.0, 0.1), (0.0, 0.0, 0.0)),  # before its beginning
        ((0.5, 0.1, 0.15), (0.4, 0.0, 0.15)),  # nearer to the post to the next axis
    ],
)
def test_a_sensor_off_its_link_stands_on_a_strut(
    place: tuple[float, float, float], foot: tuple[float, ...]
) -> None:
    joints = (Joint(a_m=0.4), Joint(d_m=0.3, a_m=0.1), Joint(a_m=0.2))
    bare = link_meshes(Arm("a", joints))[0]
    held = link_meshes(Arm("a", joints, sensors=(Sensor("s", 1, place), Sensor("other", 2, (0.1, 0.0, 0.0)))))[0]
    assert len(shells(held)) == len(shells(bare)) + 1
    strut = shells(held)[-1]
    along = np.subtract(place, foot)
    length = float(np.linalg.norm(along))
    heights = (strut.vertices - foot) @ along / length
    thick = np.linalg.norm(strut.vertices - foot - heights[:, None] * along / length, axis=1).max()
    assert (heights.min() + thick, heights.max() - thick) == pytest.approx((0.0, length), abs=1e-3)
    assert 0.1 < thick / 0.055 < 0.25


@pytest.mark.parametrize("off", [0.0, 0.03])
def test_a_sensor_on_its_beam_needs_no_strut(off: float) -> None:
    bare = link_meshes(STRAIGHT)[0]
    held = link_meshes(replace(STRAIGHT, sensors=(Sensor("s", 1, (0.2, off, 0.0)),)))[0]
    assert len(shells(held)) == len(shells(bare))


def test_the_farthest_sensor_is_where_a_last_link_without_length_ends() -> None:
    joints = (Joint(a_m=0.5), Joint())
    sensors = (
        Sensor("near", 2, (0.0, 0.1, 0.0)),
        Sensor("far", 2, (0.0, 0.0, 0.3)),
        Sensor("else", 1, (0.9, 0, 0)),
    )
    arm = Arm("hand", joints, sensors=sensors)
    assert reach_m(arm) == pytest.approx(0.5 + 0.3)
    assert link_meshes(arm)[1].vertices[:, 2].max() == pytest.approx(0.3, abs=0.05)
    assert reach_m(replace(arm, tip=Tip("near", (0.0, 0.1, 0.0)))) == pytest.approx(0.5 + 0.2)
    assert reach_m(replace(arm, tip=Tip("else", (0.0, 0.0, 0.0)))) == pytest.approx(0.5 + 0.3)


def test_an_arm_without_any_length_reaches_a_metre() -> None:
    assert reach_m(Arm("dot", (Joint(), Joint()))) == 1.0
    assert reach_m(Arm("short", (Joint(a_m=-0.2, d_m=-0.1), Joint(a_m=0.1)))) == pytest.approx(0.4)
