"""Eq. (1) for axes that are known as lines: from anatomy, or from a functional calibration.

Frame i - 1 lies on axis i, and link i reaches perpendicularly from axis i to any point of axis i + 1. So a point
and a direction of every axis, in one pose, fix all five numbers of each joint; the next point is the choice that
a common normal would make otherwise, far outside the body where two axes are nearly parallel.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats, Joint

#: Links shorter than this have no direction of their own [m].
_SHORTEST_M = 1e-9


@dataclass(frozen=True)
class AxisLines:
    """Axes in the pose in which all joint positions are zero, in the base frame.

    Attributes
    ----------
    points : (n + 1, 3) [m]
        A point on every axis, the origin on the first; then the tip.
    directions : (n, 3)
        Of the axes, of length one.
    forward : (3,) or (n, 3)
        Where link frames point whose link has no length in their own x-y plane; one direction, or one a joint.
    """

    points: Floats
    directions: Floats
    forward: Floats

    def frames(self) -> Floats:
        """Return the poses of the joint-axis frames, (n, 4, 4)."""
        n = len(self.directions)
        frames = np.tile(np.eye(4), (n, 1, 1))
        forward = np.broadcast_to(self.forward, (n, 3))
        for i in range(n):
            z, here = self.directions[i], self.points[i]
            step = self.points[i + 1] - here
            d = float(step @ z)
            x = step - d * z
            if np.linalg.norm(x) < _SHORTEST_M:
                x = _across(z, forward[i])
            x = x / np.linalg.norm(x)
            frames[i, :3, :3] = np.column_stack([x, np.cross(z, x), z])
            frames[i, :3, 3] = here + d * z
        return frames

    def joints(self, before: Floats | None = None) -> list[Joint]:
        """Return the joints' geometry, eq. (1): all of them turn, and no link has a mass.

        Parameters
        ----------
        before : (3, 3), optional
            The axes, as columns, of the link that the first joint hangs on; the base frame's unless given.
        """
        before, joints = np.eye(3) if before is None else before, list[Joint]()
        for i, frame in enumerate(self.frames()):
            z, x = before.T @ frame[:3, 2], before.T @ frame[:3, 0]
            # The third column of Rot(y, beta) Rot(x, alpha) is (cos a sin b, -sin a, cos a cos b).
            alpha, beta = np.arcsin(np.clip(-z[1], -1.0, 1.0)), np.arctan2(z[0], z[2])
            turned = _rot_y(beta) @ _rot_x(alpha)
            theta = np.arctan2(turned[:, 1] @ x, turned[:, 0] @ x)
            step = self.points[i + 1] - self.points[i]
            joints.append(
                Joint(
                    alpha_rad=float(alpha),
                    a_m=float(max(step @ frame[:3, 0], 0.0)),
                    d_m=float(step @ frame[:3, 2]),
                    beta_rad=float(beta),
                    theta_offset_rad=float(theta),
                )
            )
            before = frame[:3, :3]
        return joints


def _across(z: Floats, forward: Floats) -> Floats:
    """Return the part of a direction that is perpendicular to an axis; any one if there is none."""
    across = forward - (forward @ z) * z
    if np.linalg.norm(across) > _SHORTEST_M:
        return np.asarray(across)
    other = np.eye(3)[int(np.argmin(np.abs(z)))]
    return np.asarray(other - (other @ z) * z)


def _rot_x(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _rot_y(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
