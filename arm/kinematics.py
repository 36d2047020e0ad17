"""Where the arm is: eq. (1), (2) and (3).

Two frames belong to link i. Its *joint-axis frame* has its origin on axis i and x along the link; inertial
parameters and sensors are given there. *Frame i* of the paper is the same frame moved by ``a`` along x, to
the far end of the link. In a tree the frame before is that of the parent, moved to where the joint hangs on it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, chain_of, joint_rows, move
from arm.model import Arm, Floats, Marker, Sensor
from arm.sine_cosine import sines_cosines
from limbcal.compiled import compiled


def link_transforms(arm: Arm, q: Floats) -> Floats:
    """Return 0T_i for every link, eq. (2).

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_joint, 4, 4)
        Pose of frame i, at the far end of link i, in the base frame.
    """
    return far_ends(chain_of(arm), joint_rows(arm, "q", q))


def axis_frames(arm: Arm, q: Floats) -> Floats:
    """Return the pose of every link's joint-axis frame in the base frame.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_joint, 4, 4)
    """
    return frames_of(chain_of(arm), joint_rows(arm, "q", q))


def frames_of(chain: Chain, q: Floats) -> Floats:
    """Return what `axis_frames` returns, of a chain and ``q`` that is (n_sample, n_joint) and contiguous."""
    T = np.zeros((*q.shape, 4, 4))
    _axis_frames(chain, q, T)
    return T


def far_ends(chain: Chain, q: Floats) -> Floats:
    """Return what `link_transforms` returns, of a chain and ``q`` that is (n_sample, n_joint) and contiguous."""
    T = frames_of(chain, q)
    T[..., :3, 3] += chain.geometry[:, 1, None] * T[..., :3, 0]  # Trans(a, 0, 0), the last factor of eq. (1)
    return T


def local_frames(arm: Arm, q: Floats) -> Floats:
    """Return the pose of every link's joint-axis frame in that of its parent, or in the base frame.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_joint, 4, 4)
    """
    frames = axis_frames(arm, q)
    local, parents = frames.copy(), np.array(arm.parents)
    hung = np.flatnonzero(parents >= 0)
    local[:, hung] = np.linalg.solve(frames[:, parents[hung]], frames[:, hung])
    return local


def tip_position(arm: Arm, q: Floats) -> Floats:
    """Return the tip r = f(alpha, a, theta, d, beta), eq. (3): the origin of frame n, of a tree's last link.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, 3) [m]
    """
    return tips_of(chain_of(arm), joint_rows(arm, "q", q))


def tips_of(chain: Chain, q: Floats) -> Floats:
    """Return what `tip_position` returns, of a chain and ``q`` that is (n_sample, n_joint) and contiguous."""
    tips = np.empty((len(q), 3))
    _tips(chain, q, tips)
    return tips


def sensor_positions(arm: Arm, q: Floats) -> Floats:
    """Return where every sensor is in the base frame.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_sensor, 3) [m]
    """
    return positions_on_links(arm, q, arm.sensors)


def positions_on_links(arm: Arm, q: Floats, mounted: Sequence[Sensor | Marker]) -> Floats:
    """Return where what is mounted on links is in the base frame, (n_sample, n, 3) [m]; joint 0 is the base."""
    frames = axis_frames(arm, q)
    points = np.empty((len(frames), len(mounted), 3))
    for k, one in enumerate(mounted):
        if one.joint == 0:
            points[:, k] = one.position_m
            continue
        T = frames[:, one.joint - 1]
        points[:, k] = T[:, :3, :3] @ np.array(one.position_m) + T[:, :3, 3]
    return points


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Floats:
    """Return Rot(z, yaw) Rot(y, pitch) Rot(x, roll): the axes of the turned frame as columns.

    Returns
    -------
    (3, 3)
    """
    cr, sr, cp, sp, cy, sy = (f(x) for x in (roll, pitch, yaw) for f in (np.cos, np.sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_rotation(rotation: Floats) -> Floats:
    """Return roll, pitch and yaw, (3,), pitch within +-90 degrees: the inverse of `rotation_from_rpy`.

    Parameters
    ----------
    rotation : (3, 3)
    """
    pitch = np.arcsin(np.clip(-rotation[2, 0], -1.0, 1.0))
    if np.hypot(rotation[0, 0], rotation[1, 0]) < 1e-12:  # roll and yaw share an axis: all of it is roll
        return np.array([np.arctan2(-rotation[1, 2], rotation[1, 1]), pitch, 0.0])
    roll, yaw = np.arctan2(rotation[2, 1], rotation[2, 2]), np.arctan2(rotation[1, 0], rotation[0, 0])
    return np.array([roll, pitch, yaw])


@compiled
def _axis_frames(chain: Chain, q: Floats, T: Floats) -> None:
    sine, cosine = sines_cosines(q)
    R, p = chain.zero_R.copy(), chain.zero_p.copy()
    for k in range(q.shape[0]):
        move(chain, q[k], cosine[k], sine[k], R, p)
        _fill_in(chain.parent, R, p, T[k])


@compiled
def _fill_in(parent: NDArray[np.int64], R: Floats, p: Floats, T: Floats) -> None:
    """Fill in the frames of one sample, (n_joint, 4, 4), from their poses in their parents'; the rest is zero."""
    for i in range(parent.size):
        now = T[i]
        now[3, 3] = 1.0
        if parent[i] < 0:
            now[:3, :3] = R[i]
            now[:3, 3] = p[i]
            continue
        before = T[parent[i]]
        for row in range(3):
            x, y, z = before[row, 0], before[row, 1], before[row, 2]
            now[row, 3] = before[row, 3] + x * p[i, 0] + y * p[i, 1] + z * p[i, 2]
            for col in range(3):
                now[row, col] = x * R[i, 0, col] + y * R[i, 1, col] + z * R[i, 2, col]


@compiled
def _tips(chain: Chain, q: Floats, tips: Floats) -> None:
    sine, cosine = sines_cosines(q)
    last = q.shape[1] - 1
    R, p, T = chain.zero_R.copy(), chain.zero_p.copy(), np.zeros((q.shape[1], 4, 4))
    for k in range(q.shape[0]):
        move(chain, q[k], cosine[k], sine[k], R, p)
        _fill_in(chain.parent, R, p, T)
        for row in range(3):
            tips[k, row] = T[last, row, 3] + chain.geometry[last, 1] * T[last, row, 0]
