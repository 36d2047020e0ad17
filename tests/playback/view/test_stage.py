"""Ground, light and camera: up is against gravity, all of the motion is in view, and the ground is under it."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from arm.arm_file import load_arm
from playback.shape import reach_m
from playback.view.stage import ASPECT, FIELD_OF_VIEW, Stage, upwards

ARM = load_arm("dd-arm")
TIPS = np.array([[0.3, -0.4, 0.1], [-0.2, 0.5, 0.6]])
GRAVITIES = [(0.0, 0.0, -9.81), (0.0, -9.81, 0.0), (9.81, 0.0, 0.0), (0.0, 0.0, 0.0)]
UPS = [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]


class Page:
    """Keeps what is put on its scene, by name, and where its camera is."""

    def __init__(self) -> None:
        self.scene = self
        self.parts: dict[str, Any] = {}
        self.initial_camera = SimpleNamespace()
        self.up: np.ndarray = np.zeros(3)

    def set_up_direction(self, up: np.ndarray) -> None:
        self.up = up.copy()

    def configure_default_lights(self, enabled: bool) -> None:
        self.parts["default lights"] = enabled

    def _add(self, name: str, **known: Any) -> Any:
        self.parts[name] = SimpleNamespace(**known)
        return self.parts[name]

    add_grid = add_light_hemisphere = add_light_directional = _add


def staged(gravity: tuple[float, float, float]) -> tuple[Page, Stage]:
    page = Page()
    return page, Stage(page, replace(ARM, gravity_m_s2=gravity), TIPS)  # type: ignore[arg-type] - a scene is enough


@pytest.mark.parametrize(("gravity", "up"), [*zip(GRAVITIES, UPS, strict=True)])
def test_up_is_against_gravity(gravity: tuple[float, float, float], up: tuple[float, float, float]) -> None:
    page, _ = staged(gravity)
    assert page.up == pytest.approx(up)
    assert upwards(replace(ARM, gravity_m_s2=gravity)) == int(np.argmax(np.abs(up)))
    for light in ("/light/key", "/light/fill"):
        assert np.array(page.parts[light].position) @ page.up > 0.0  # from above
    assert page.parts["default lights"] is False


@pytest.mark.parametrize("gravity", GRAVITIES)
def test_the_ground_is_level_and_under_all_places_of_the_tip(gravity: tuple[float, float, float]) -> None:
    page, _ = staged(gravity)
    ground = page.parts["/ground"]
    assert ground.plane == ("yz", "xz", "xy")[int(np.argmax(np.abs(page.up)))]
    heights = np.vstack([TIPS, np.zeros(3)]) @ page.up
    below = heights.min() - np.array(ground.position) @ page.up
    assert 0.1 * reach_m(ARM) < below < 0.2 * reach_m(ARM)
    assert 0.05 * reach_m(ARM) < ground.cell_size < reach_m(ARM)
    assert ground.section_size == pytest.approx(2.0 * ground.cell_size)


@pytest.mark.parametrize("gravity", GRAVITIES)
@pytest.mark.parametrize("two", [False, True])
def test_all_places_of_the_tip_are_in_view(gravity: tuple[float, float, float], two: bool) -> None:
    page, stage = staged(gravity)
    stage.look(two)
    camera = page.initial_camera
    ahead = camera.look_at - camera.position
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, page.up)
    right /= np.linalg.norm(right)
    above = np.cross(right, ahead)
    places = np.vstack([TIPS, np.zeros(3)])
    if two:
        places = np.vstack([places, places + stage.beside])
    seen = places - camera.position
    depth = seen @ ahead
    half = np.tan(0.5 * camera.fov)
    assert camera.fov == FIELD_OF_VIEW
    assert np.all(depth > 0.0)
    assert np.all(np.abs(seen @ above) <= half * depth)
    assert np.all(np.abs(seen @ right) <= ASPECT * half * depth)
    assert camera.position @ page.up > camera.look_at @ page.up  # from above
    widest = max(np.abs(seen @ above / depth).max(), np.abs(seen @ right / depth).max() / ASPECT)
    assert widest > 0.25 * half  # not from far away


def test_two_arms_stand_clear_of_each_other() -> None:
    page, stage = staged(GRAVITIES[0])
    width = np.ptp(np.vstack([TIPS, np.zeros(3)]), axis=0) @ np.abs(stage.beside / np.linalg.norm(stage.beside))
    assert np.linalg.norm(stage.beside) > width
    assert stage.beside @ page.up == pytest.approx(0.0)


def test_shadows_are_cast_where_they_are_wanted() -> None:
    page, stage = staged(GRAVITIES[0])
    assert page.parts["/light/key"].cast_shadow is False
    stage.shade(True)
    assert page.parts["/light/key"].cast_shadow is True


def test_where_the_tip_gets_to_is_found_where_nobody_says_it() -> None:
    page = Page()
    stage = Stage(page, ARM)  # type: ignore[arg-type]
    assert reach_m(ARM) < np.linalg.norm(stage.beside) < 3.0 * reach_m(ARM)
