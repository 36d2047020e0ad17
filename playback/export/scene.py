"""Pictures of the arms as they move, over a grid, with the path of the tip."""

from dataclasses import dataclass

import numpy as np
from PIL import Image as Pil
from PIL import ImageDraw

from playback.export.camera import Camera, look_at
from playback.export.raster import FAR, FINER, Image, Picture, draw_mesh, draw_stroke, lay_over, resolve
from playback.export.sampled import Mover
from playback.export.surface import with_normals
from playback.shape import Faces, Rgb, base_mesh, link_meshes, link_poses, reach_m, rgb, sensor_mesh
from playback.trajectory import Floats

PAPER, GRID, GRID_AXIS = rgb("fafafc"), rgb("e4e6eb"), rgb("cdd1d9")
TWIN_OPACITY = 0.62
TRACE_PX, PALE = 1.3, 0.3  # of the tip's path


@dataclass(frozen=True)
class _Part:
    """A mesh that rides on a link (or, with -1, stands on the ground), ready to be drawn."""

    link: int
    vertices: Floats
    normals: Floats
    faces: Faces
    colour: Floats


class Scene:
    """Draws one frame after another.

    Parameters
    ----------
    movers : tuple of Mover
        The first is solid, one more is seen through.
    width, height : int
        Of the pictures [px].
    head : int
        What is kept free above for words [px].

    Attributes
    ----------
    grid_m : float
        Between two lines of the grid.
    """

    def __init__(self, movers: tuple[Mover, ...], width: int, height: int, head: int = 0) -> None:
        self._movers = movers
        self._camera = look_at(movers, FINER * width, FINER * height, FINER * head)
        self._poses = [link_poses(mover.posed, mover.q) for mover in movers]
        self._parts = [_parts(mover, k == 0) for k, mover in enumerate(movers)]
        self._tips = [self._camera.project(mover.tip)[:, :2] for mover in movers]
        self.grid_m = _round_length(0.25 * reach_m(movers[0].arm))
        self._ground = _ground(self._camera, self.grid_m, FINER * width, FINER * height)
        self._image, self._other = np.empty_like(self._ground), np.empty_like(self._ground)
        self._depth = np.empty(self._ground.shape[:2], np.float32)
        self._other_depth = np.empty_like(self._depth)
        self._picture = np.empty((height, width, 3), np.uint8)

    def draw(self, frame: int) -> Picture:
        """Return the picture of a frame, to be asked for in their order: the path of the tip grows."""
        for mover, tip in zip(self._movers, self._tips, strict=True):
            colour = PALE * np.array(PAPER) + (1.0 - PALE) * np.array(mover.colours.trace)
            last = max(frame - 1, 0)
            draw_stroke(tip[last], tip[frame], FINER * TRACE_PX, colour, 1.0, self._ground)
        self._image[:] = self._ground
        self._depth[:] = FAR
        self._draw(0, frame, self._image, self._depth)
        if len(self._movers) > 1:
            self._other[:] = self._image
            self._other_depth[:] = FAR
            self._draw(1, frame, self._other, self._other_depth)
            lay_over(self._other, self._other_depth, TWIN_OPACITY, self._image, self._depth)
        resolve(self._image, self._picture)
        return self._picture

    def _draw(self, index: int, frame: int, image: Image, depth: Image) -> None:
        for part in self._parts[index]:
            T = np.eye(4) if part.link < 0 else self._poses[index][frame, part.link]
            corners = self._camera.project(part.vertices @ T[:3, :3].T + T[:3, 3])
            normals = part.normals @ T[:3, :3].T @ self._camera.axes.T
            draw_mesh(corners, normals, part.faces, part.colour, image, depth)


def _parts(mover: Mover, with_base: bool) -> list[_Part]:
    arm, colours = mover.arm, mover.colours
    meshes = [(-1, base_mesh(arm), colours.base)] if with_base else []  # the two stand on one base
    meshes += [(i, mesh, colours.link) for i, mesh in enumerate(link_meshes(arm))]
    meshes += [(sensor.joint - 1, sensor_mesh(arm, sensor), colours.sensor) for sensor in arm.sensors]
    parts = []
    for link, mesh, colour in meshes:
        split, normals = with_normals(mesh)
        parts.append(_Part(link, split.vertices, normals, split.faces, np.array(colour, dtype=float)))
    return parts


def _ground(camera: Camera, step: float, width: int, height: int) -> Image:
    """Return the empty scene: paper, and the grid of the plane on which the arm stands."""
    paper = Pil.new("RGB", (width, height), PAPER)
    pen = ImageDraw.Draw(paper)
    along, across, place = camera.floor
    n = int(np.ceil(2.0 * np.hypot(width, height) / (camera.scale * step)))
    far = n * step
    lines = [(k, *pair) for pair in ((along, across), (across, along)) for k in range(-n, n + 1)]
    for k, one, other in sorted(lines, key=lambda line: line[0] == 0):  # the axes over all others
        middle = place + k * step * one
        ends = camera.project(np.array([middle - far * other, middle + far * other]))
        colour: Rgb = GRID_AXIS if k == 0 else GRID
        pen.line([tuple(end[:2]) for end in ends.tolist()], fill=colour, width=FINER)
    return np.asarray(paper, dtype=np.float32).copy()


def _round_length(length: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten up to a length."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(power * k for k in (1.0, 2.0, 5.0) if power * k <= length * (1.0 + 1e-9)))
