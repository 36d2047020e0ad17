"""What the arm stands on, how it is lit, and where the page looks from."""

import numpy as np
import viser

from arm.kinematics import tip_position
from arm.model import Arm
from playback.shape import reach_m, rgb
from playback.trajectory import Floats

BACKGROUND = rgb("ffffff")
CELL, SECTION = rgb("dee2e7"), rgb("c6cdd5")
#: Poses that say how much room an arm needs.
DRAWS = 400
FIELD_OF_VIEW, ASPECT = np.radians(38.0), 0.95
#: How much the camera looks down: the tangent of the angle.
SLANT = 0.9


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
    tips : (k, 3), optional
        Where the tip gets to [m]; without it, anywhere that joints may be.

    Attributes
    ----------
    beside : (3,)
        From an arm to one that stands clear of it [m].
    """

    def __init__(self, server: viser.ViserServer, arm: Arm, tips: Floats | None = None) -> None:
        self._server, self._reach = server, reach_m(arm)
        self._axis = upwards(arm)
        self._up = np.zeros(3)
        self._up[self._axis] = -np.sign(arm.gravity_m_s2[self._axis]) or 1.0
        self._right = np.roll(np.array([1.0, 0.0, 0.0]), self._axis - 2)
        self._back = np.cross(self._right, self._up)
        margin = 0.12 * self._reach
        tips = _anywhere(arm, self._reach) if tips is None else tips
        self._low, self._high = tips.min(axis=0, initial=0.0) - margin, tips.max(axis=0, initial=0.0) + margin
        self.beside = float((self._high - self._low) @ np.abs(self._right)) * self._right
        server.scene.set_up_direction(self._up)
        self._ground()
        self._light()

    def look(self, two: bool) -> None:
        """Have pages that open look at one arm, or at two beside each other."""
        middle, size = 0.5 * (self._low + self._high), self._high - self._low
        if two:
            middle, size = middle + 0.5 * self.beside, size + np.abs(self.beside)
        width, height = float(size @ np.abs(self._right)), float(size @ np.abs(self._up))
        depth = float(size @ np.abs(self._back))
        camera = self._server.initial_camera
        camera.look_at = middle
        camera.up = self._up
        camera.fov = FIELD_OF_VIEW
        # as far as makes the width fit into a window that is about as wide as high beside the panel
        away = 0.5 * max(width / ASPECT, height + 0.6 * depth) / np.tan(0.5 * FIELD_OF_VIEW) + 0.45 * depth
        slant = self._back + SLANT * self._up + 0.08 * self._right
        camera.position = middle + away * slant / np.linalg.norm(slant)

    def shade(self, wanted: bool) -> None:
        """Have the arm cast a shadow, which takes a page without a graphics processor most of its time."""
        self._key.cast_shadow = wanted

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
        scene.add_light_hemisphere(
            "/light/sky", sky_color=rgb("ffffff"), ground_color=rgb("cdcdd2"), intensity=1.4
        )
        key = far * (self._up + 0.5 * self._right + 0.35 * np.cross(self._right, self._up))
        self._key = scene.add_light_directional(
            "/light/key", color=rgb("fffcf6"), intensity=1.7, cast_shadow=False, position=_triple(key)
        )
        fill = far * (0.4 * self._up - self._right)
        scene.add_light_directional("/light/fill", color=rgb("ebf2ff"), intensity=0.5, position=_triple(fill))


def _anywhere(arm: Arm, reach: float) -> Floats:
    """Return places of the tip, (k, 3) [m], drawn from all that the joints allow."""
    rng = np.random.default_rng(0)
    span = np.where([joint.type == "revolute" for joint in arm.joints], np.pi, 0.3 * reach)
    return tip_position(arm, rng.uniform(-1.0, 1.0, (DRAWS, arm.n_joint)) * span)


def _triple(place: Floats) -> tuple[float, float, float]:
    x, y, z = place.tolist()
    return x, y, z
