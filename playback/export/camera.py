"""From where an arm is looked at, and how large it is then."""

import itertools
from dataclasses import dataclass

import numpy as np

from arm.kinematics import axis_frames
from arm.model import Arm
from playback.export.gravity import upward
from playback.export.sampled import Mover
from playback.shape import base_mesh, link_meshes, link_poses
from playback.trajectory import Floats

TILT_DEG = 24.0  # from the axis of a planar arm, so that it looks solid
AROUND_DEG, ABOVE_DEG = -55.0, 22.0  # where the viewer of any other arm stands
FILLED = 0.9  # of the picture's smaller side
LOOKS = 200  # how many instants decide on what must be seen


@dataclass(frozen=True)
class Camera:
    """A parallel projection.

    Parameters
    ----------
    axes : ndarray of shape (3, 3)
        Rows: right, up, towards the viewer, in the base frame.
    scale : float
        [px/m]
    origin : ndarray of shape (2,)
        Where the base frame's origin is in the picture: right, down [px].
    floor : ndarray of shape (3, 3)
        Two directions of the plane on which the arm stands, the first of them the picture's right, and a point
        of it. The plane is never seen from its edge.
    """

    axes: Floats
    scale: float
    origin: Floats
    floor: Floats

    def project(self, points: Floats) -> Floats:
        """Return right and down [px] and the nearness of points (…, 3) in the base frame."""
        seen = points @ self.axes.T * self.scale
        seen[..., 1] *= -1.0
        seen[..., :2] += self.origin
        return np.asarray(seen)


def look_at(movers: tuple[Mover, ...], width: int, height: int, head: int = 0) -> Camera:
    """Return a camera that sees all of a motion: along the axis of a planar arm, else from the side and above.

    ``head`` is what is kept free above [px].
    """
    arm, up = movers[0].arm, upward(movers[0].arm)
    axis = _common_axis(arm)
    if axis is None:
        axes, normal = _standing(up), up
    else:
        axes, normal = _above(axis, up), axis
    base = base_mesh(arm).vertices
    places = [base @ axes.T]
    for mover in movers:
        every = max(1, len(mover.q) // LOOKS)
        poses = link_poses(mover.posed, mover.q[::every])
        for i, mesh in enumerate(link_meshes(mover.arm)):
            corners = _box_corners(mesh.vertices)
            at = np.einsum("nij,kj->nki", poses[:, i, :3, :3], corners) + poses[:, i, None, :3, 3]
            places.append(at.reshape(-1, 3) @ axes.T)
    seen = np.concatenate(places)[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    scale = FILLED * float(np.min(np.array([width, height - head]) / (high - low)))
    centre = 0.5 * (low + high) * [1.0, -1.0]
    floor = np.array([axes[0], np.cross(normal, axes[0]), normal * float((base @ normal).min())])
    return Camera(axes, scale, np.array([width, height + head]) / 2.0 - scale * centre, floor)


def _box_corners(points: Floats) -> Floats:
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array(list(itertools.product(*zip(low, high, strict=True))))


def _common_axis(arm: Arm) -> Floats | None:
    """Return the direction of all axes of a planar arm, the one that lies more with the base frame's z."""
    if any(joint.type != "revolute" for joint in arm.joints):
        return None
    axes = axis_frames(arm, np.zeros((1, arm.n_joint)))[0, :, :3, 2]
    if np.abs(axes @ axes[0]).min() < 1.0 - 1e-3:
        return None
    return np.asarray(axes[0] if axes[0, 2] >= 0.0 else -axes[0])


def _above(axis: Floats, up: Floats) -> Floats:
    """Return the view along an axis, upward up where it can be, tilted a little."""
    _, y, z = np.eye(3)
    across = (direction - (direction @ axis) * axis for direction in (up, y, z))
    vertical = next(part for part in across if np.linalg.norm(part) > 0.1)
    vertical /= np.linalg.norm(vertical)
    c, s = np.cos(np.radians(TILT_DEG)), np.sin(np.radians(TILT_DEG))
    return np.array([np.cross(vertical, axis), c * vertical + s * axis, c * axis - s * vertical])


def _standing(up: Floats) -> Floats:
    """Return the view from the side and above."""
    ahead = np.eye(3)[np.argmin(np.abs(up))]
    ahead = ahead - (ahead @ up) * up
    ahead /= np.linalg.norm(ahead)
    aside = np.cross(up, ahead)
    around, above = np.radians([AROUND_DEG, ABOVE_DEG])
    out = np.cos(around) * ahead + np.sin(around) * aside
    viewer = np.cos(above) * out + np.sin(above) * up
    right = np.cross(up, out)
    return np.array([right, np.cross(viewer, right), viewer])
