"""The arm on the page: its parts are where the arm's transforms put them."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions
from arm.model import Arm, Marker
from playback.shape import REAL, link_poses, reach_m, sensor_mesh
from playback.view.figure import Figure


class Scene:
    """Keeps what is put on it, by its name."""

    def __init__(self) -> None:
        self.scene = self
        self.parts: dict[str, Any] = {}

    def _add(self, name: str, **known: Any) -> Any:
        part = SimpleNamespace(name=name, visible=True, position=np.zeros(3), wxyz=np.array([1.0, 0.0, 0.0, 0.0]))
        vars(part).update(known)
        self.parts[name] = part
        return part

    def add_frame(self, name: str, **looks: Any) -> Any:
        return self._add(name, **looks)

    def add_mesh_simple(self, name: str, vertices: np.ndarray, faces: np.ndarray, **looks: Any) -> Any:
        return self._add(name, vertices=vertices, faces=faces, **looks)

    def add_icosphere(self, name: str, radius: float, position: tuple[float, float, float], **looks: Any) -> Any:
        return self._add(name, radius=radius, **looks | {"position": np.array(position)})

    def add_label(self, name: str, text: str, position: tuple[float, float, float], **looks: Any) -> Any:
        return self._add(name, text=text, **looks | {"position": np.array(position)})


@pytest.fixture(params=["dd-arm", "spatial-arm"])
def arm(request: pytest.FixtureRequest) -> Arm:
    return load_arm(request.param)


@pytest.fixture
def scene() -> Scene:
    return Scene()


@pytest.fixture
def figure(scene: Scene, arm: Arm) -> Figure:
    return Figure(scene, "/arm", arm, REAL)  # type: ignore[arg-type] - of a server it asks for a scene alone


def turned(wxyz: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return a vector turned by a quaternion."""
    w, u = wxyz[0], np.asarray(wxyz[1:])
    return v + 2.0 * np.cross(u, np.cross(u, v) + w * v)


def test_links_are_moved_as_the_joints_are(scene: Scene, figure: Figure, arm: Arm) -> None:
    for q in (np.zeros(arm.n_joint), np.linspace(0.4, -1.1, arm.n_joint)):
        figure.show(q)
        poses = link_poses(arm, q[None])[0]
        for k, pose in enumerate(poses):
            link = scene.parts[f"/arm/link{k + 1}"]
            assert link.position == pytest.approx(pose[:3, 3])
            for axis in np.eye(3):
                assert turned(link.wxyz, axis) == pytest.approx(pose[:3, :3] @ axis, abs=1e-9)


def test_sensors_ride_where_they_are_and_their_names_above(scene: Scene, figure: Figure, arm: Arm) -> None:
    q = np.linspace(0.4, -1.1, arm.n_joint)
    figure.show(q)
    for sensor, place in zip(arm.sensors, sensor_positions(arm, q[None])[0], strict=True):
        link = scene.parts[f"/arm/link{sensor.joint}"]
        label = scene.parts[f"/arm/link{sensor.joint}/label {sensor.name}"]
        assert label.text == sensor.name
        below = label.position - [0.0, 0.0, 0.08 * reach_m(arm)]
        assert link.position + turned(link.wxyz, below) == pytest.approx(place)
        mesh = scene.parts[f"/arm/link{sensor.joint}/{sensor.name}"]
        assert mesh.vertices == pytest.approx(sensor_mesh(arm, sensor).vertices)


def test_what_is_not_wanted_is_not_seen(scene: Scene, figure: Figure, arm: Arm) -> None:
    def seen(word: str) -> set[bool]:
        return {part.visible for name, part in scene.parts.items() if word in name}

    figure.seen(labels=False)
    assert seen("label") == {False} and seen("axes") == {True} and scene.parts["/arm"].visible
    figure.seen(sensors=False)
    assert seen("label") == {False}  # no names of what is not there
    assert {scene.parts[f"/arm/link{one.joint}/{one.name}"].visible for one in arm.sensors} == {False}
    figure.seen(axes=False)
    assert seen("label") == {True} and seen("axes") == {False}
    figure.seen(arm=False)
    assert not scene.parts["/arm"].visible


def test_an_arm_that_is_seen_through_casts_no_shadow(arm: Arm) -> None:
    for opacity, shadow in ((None, True), (0.5, False)):
        scene = Scene()
        Figure(scene, "/arm", arm, REAL, opacity)  # type: ignore[arg-type]
        bodies = [part for name, part in scene.parts.items() if name.endswith("/body")]
        assert len(bodies) == arm.n_joint
        assert {(body.opacity, body.cast_shadow) for body in bodies} == {(opacity, shadow)}


def test_its_base_is_put_somewhere(scene: Scene, figure: Figure) -> None:
    figure.stand_at(np.array([1.0, 2.0, 3.0]))
    assert scene.parts["/arm"].position == pytest.approx([1.0, 2.0, 3.0])


def test_optical_markers_ride_on_their_links(scene: Scene) -> None:
    leg = load_arm("human-leg-right")
    markers = (Marker("ASIS", 0, (0.1, 0.0, 0.1)), Marker("knee", 3, (0.0, 0.05, 0.4)))
    figure = Figure(scene, "/leg", replace(leg, markers=markers), REAL)  # type: ignore[arg-type]
    assert np.array_equal(scene.parts["/leg/marker ASIS"].position, markers[0].position_m)
    assert np.array_equal(scene.parts["/leg/link3/marker knee"].position, markers[1].position_m)
    figure.seen(sensors=False)
    assert not scene.parts["/leg/link3/marker knee"].visible
