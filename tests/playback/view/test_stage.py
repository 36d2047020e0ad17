"""Ground, light and camera: up is against gravity, all of the motion is in view, and the ground is under it."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Joint
from playback.shape import reach_m
from playback.view.stage import ASPECT, FIELD_OF_VIEW, Stage, upwards

ARM = load_arm("dd-arm")
ARM_UPRIGHT = replace(ARM, gravity_m_s2=(0.0, 0.0, -9.81))
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


@pytest.mark.parametrize(
    ("lengths", "cell"), [((0.25, 0.3), 0.05), ((0.6, 0.39), 0.05), ((0.6, 0.41), 0.5), ((5.0, 7.0), 5.0)]
)
def test_the_ground_s_cells_are_half_a_power_of_ten(lengths: tuple[float, float], cell: float) -> None:
    page = Page()
    arm = Arm("two", tuple(Joint(a_m=length) for length in lengths))
    Stage(page, arm, TIPS)  # type: ignore[arg-type]
    assert page.parts["/ground"].cell_size == pytest.approx(cell)


WIDE = np.array([[3.0, 0.0, 0.1], [-3.0, 0.1, 0.0]])


@pytest.mark.parametrize(
    ("tips", "two", "middle", "away"),
    [  # by hand, for a reach of 0.55 m and so a margin of 0.066 m
        (TIPS, False, (0.05, 0.05, 0.3), 0.5 * (0.732 + 0.6 * 1.032) / np.tan(np.radians(19.0)) + 0.45 * 1.032),
        (TIPS, True, (0.366, 0.05, 0.3), 0.5 * (0.732 + 0.6 * 1.032) / np.tan(np.radians(19.0)) + 0.45 * 1.032),
        (WIDE, False, (0.0, 0.05, 0.05), 0.5 * 6.132 / 0.95 / np.tan(np.radians(19.0)) + 0.45 * 0.232),
    ],
)
def test_the_camera_looks_from_the_front_and_above(
    tips: np.ndarray, two: bool, middle: tuple[float, float, float], away: float
) -> None:
    page = Page()
    stage = Stage(page, ARM_UPRIGHT, tips)  # type: ignore[arg-type]
    stage.look(two)
    camera = page.initial_camera
    assert camera.look_at == pytest.approx(middle)
    assert camera.up == pytest.approx([0.0, 0.0, 1.0])
    assert camera.fov == pytest.approx(np.radians(38.0))
    slant = np.array([0.08, -1.0, 0.9])
    assert camera.position - camera.look_at == pytest.approx(away * slant / np.linalg.norm(slant))


def test_an_arm_s_width_and_margins_are_between_it_and_one_beside() -> None:
    stage = Stage(Page(), ARM_UPRIGHT, TIPS)  # type: ignore[arg-type]
    assert stage.beside == pytest.approx([0.5 + 2.0 * 0.066, 0.0, 0.0])


def test_light_comes_from_above_right_and_is_filled_up_from_the_left() -> None:
    page = Page()
    Stage(page, ARM_UPRIGHT, TIPS)  # type: ignore[arg-type]
    sky, key, fill = (page.parts[f"/light/{name}"] for name in ("sky", "key", "fill"))
    assert key.position == pytest.approx((2.2 * 0.5, 2.2 * -0.35, 2.2))  # four reaches up
    assert fill.position == pytest.approx((-2.2, 0.0, 2.2 * 0.4))
    assert (sky.intensity, key.intensity, fill.intensity) == (1.4, 1.7, 0.5)
    assert (sky.sky_color, sky.ground_color) == ((255, 255, 255), (205, 205, 210))
    assert (key.color, fill.color) == ((255, 252, 246), (235, 242, 255))


def test_the_ground_is_a_pale_grid_that_fades_away() -> None:
    page = Page()
    Stage(page, ARM_UPRIGHT, TIPS)  # type: ignore[arg-type]
    ground = page.parts["/ground"]
    assert ground.position == pytest.approx((0.0, 0.0, -0.066 - 0.0011))  # just below what is lowest
    assert (ground.cell_color, ground.section_color) == ((222, 226, 231), (198, 205, 213))
    assert (ground.cell_thickness, ground.section_thickness) == (0.7, 1.0)
    assert ground.infinite_grid is True
    assert (ground.fade_distance, ground.fade_strength) == (pytest.approx(9.0 * 0.55), 1.5)
    assert (ground.fade_from, ground.shadow_opacity) == ("origin", 0.13)


def test_joints_turn_any_way_and_slide_three_tenths_of_the_reach() -> None:
    page = Page()
    Stage(page, Arm("slide", (Joint("prismatic", a_m=1.0),)))  # type: ignore[arg-type]
    assert -0.422 < page.parts["/ground"].position[2] < -0.412  # 0.3 and a margin of 0.12
    turning = Stage(Page(), Arm("turn", (Joint(a_m=1.0),)))  # type: ignore[arg-type]
    assert float(np.linalg.norm(turning.beside)) == pytest.approx(2.24, abs=1e-3)
