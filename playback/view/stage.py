"""What the arm stands on, how it is lit, and where the page looks from."""

import numpy as np
import viser

from arm.kinematics import tip_position
from arm.model import Arm
from playback.shape import reach_m
from playback.trajectory import Floats

BACKGROUND = (246, 247, 249)
CELL, SECTION = (222, 226, 231), (198, 205, 213)
#: Poses that say how much room an arm needs.
DRAWS = 400


def upwards(arm: Arm) -> int:
    """Return which axis of the base frame points up, 0 to 2; where nothing pulls it is z."""
    gravity = np.array(arm.gravity_m_s2)
    return int(np.argmax(np.abs(gravity))) if gravity.any() else 2


class Stage:
    """Ground, light and camera of an arm, or of two that stand beside each other.

    Parameters
    ----------
    server : viser.ViserServer
    arm : Arm

    Attributes
    ----------
    beside : (3,)
        From an arm to one that stands clear of it [m].
    """

    def __init__(self, server: viser.ViserServer, arm: Arm) -> None:
        self._server, self._reach = server, reach_m(arm)
        self._axis = upwards(arm)
        self._up = np.zeros(3)
        self._up[self._axis] = -np.sign(arm.gravity_m_s2[self._axis]) or 1.0
        self._low, self._high = _room(arm, self._reach)
        self._right = np.roll(np.array([1.0, 0.0, 0.0]), self._axis + 1)
        self.beside = 1.9 * self._reach * self._right
        server.scene.set_background_image(np.full((2, 2, 3), BACKGROUND, np.uint8), format="png")
        server.scene.set_up_direction(tuple(self._up))
        self._ground()
        self._light()

    def look(self, two: bool) -> None:
        """Have pages that open look at one arm, or at two beside each other."""
        middle = 0.5 * (self._low + self._high)
        if two:
            middle = middle + 0.5 * self.beside
        back = np.cross(self._right, self._up)
        away = (2.9 if two else 2.1) * self._reach
        camera = self._server.initial_camera
        camera.look_at = middle
        camera.up = self._up
        camera.fov = np.radians(40.0)
        camera.position = middle + away * (0.95 * back + 0.8 * self._up + 0.12 * self._right)

    def _ground(self) -> None:
        cell = 10.0 ** np.floor(np.log10(self._reach)) / 2.0
        where = np.zeros(3)
        where[self._axis] = (self._low if self._up[self._axis] > 0 else self._high)[self._axis]
        self._server.scene.add_grid(
            "/ground",
            plane=("yz", "xz", "xy")[self._axis],
            infinite_grid=True,
            cell_size=cell,
            section_size=2.0 * cell,
            cell_color=CELL,
            section_color=SECTION,
            cell_thickness=0.7,
            section_thickness=1.0,
            fade_distance=9.0 * self._reach,
            fade_strength=1.5,
            fade_from="origin",
            shadow_opacity=0.13,
            position=tuple(where - 0.002 * self._reach * self._up),
        )

    def _light(self) -> None:
        scene, far = self._server.scene, 4.0 * self._reach
        scene.configure_default_lights(enabled=False)
        scene.add_light_hemisphere("/light/sky", sky_color=(255, 255, 255), ground_color=(205, 205, 210), intensity=1.4)
        key = far * (self._up + 0.5 * self._right + 0.35 * np.cross(self._right, self._up))
        scene.add_light_directional("/light/key", color=(255, 252, 246), intensity=1.7, cast_shadow=True, position=key)
        fill = far * (0.4 * self._up - self._right)
        scene.add_light_directional("/light/fill", color=(235, 242, 255), intensity=0.5, position=fill)


def _room(arm: Arm, reach: float) -> tuple[Floats, Floats]:
    """Return the corners of what the arm may get to."""
    rng = np.random.default_rng(0)
    span = np.where([joint.type == "revolute" for joint in arm.joints], np.pi, 0.3 * reach)
    tips = tip_position(arm, rng.uniform(-1.0, 1.0, (DRAWS, arm.n_joint)) * span)
    margin = 0.14 * reach
    return tips.min(axis=0, initial=0.0) - margin, tips.max(axis=0, initial=0.0) + margin
