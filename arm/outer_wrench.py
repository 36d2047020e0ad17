"""Force and moment from outside at any point of any link, as the Newton-Euler equations take them up.

In the inverse part of the recursion each link passes on to the one before it what it gets from the one after it,
less what acts on it from outside. That is linear, so the outer part is a recursion of its own: it begins at the
row of the link that is touched and ends at the base. Links that are not on its way to the base do not notice.
"""

import numpy as np

from arm.chain import Chain, chain_of, joint_rows, motion_rows, poses
from arm.model import Arm, Floats
from arm.newton_euler import base_axes, inverse_dynamics, mass_matrix
from arm.triple import Triple, cross, turned
from limbcal.compiled import compiled
from limbcal.errors import DataError


def outer_joint_torque(
    arm: Arm, q: Floats, joint: int, point_m: Floats, force: Floats, moment: Floats | None = None
) -> Floats:
    """Return the joint torques that do the same work as a force and moment on a link: ``J^T (f, m)``.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]
    joint : int
        Which link is touched, counted from 1.
    point_m : (3,)
        Where, in the link's joint-axis frame.
    force, moment : (n_sample, 3) or (3,)
        What acts on the arm there, in the base frame [N], [N m].

    Returns
    -------
    (n_sample, n_joint) [N m or N]

    Raises
    ------
    DataError
        If there is no such link, or a shape does not fit.
    """
    rows = joint_rows(arm, "q", q)
    if not 1 <= joint <= arm.n_joint:
        raise DataError(f"joint is {joint}, expected one of 1 to {arm.n_joint}")
    if np.shape(point_m) != (3,):
        raise DataError(f"point_m has shape {np.shape(point_m)}, expected (3,)")
    wrench = np.zeros((len(rows), 6))
    for name, part, given in (("force", wrench[:, :3], force), ("moment", wrench[:, 3:], moment)):
        if given is not None:
            if np.shape(given) not in ((3,), (len(rows), 3)):
                raise DataError(f"{name} has shape {np.shape(given)}, expected ({len(rows)}, 3)")
            part[:] = given
    tau = np.zeros_like(rows)
    _outer_torques(chain_of(arm), rows, joint - 1, np.array(point_m, dtype=float), wrench, tau)
    return tau


def touched_inverse_dynamics(
    arm: Arm,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    joint: int,
    point_m: Floats,
    force: Floats,
    moment: Floats | None = None,
) -> Floats:
    """Return the joint torques of a motion under a force and moment at a point of a link, eq. (4).

    Parameters and errors are those of `arm.newton_euler.inverse_dynamics` and `outer_joint_torque`.

    Returns
    -------
    (n_sample, n_joint) [N m or N]
    """
    return inverse_dynamics(arm, q, dq, ddq) - outer_joint_torque(arm, q, joint, point_m, force, moment)


def touched_forward_dynamics(
    arm: Arm,
    q: Floats,
    dq: Floats,
    tau: Floats,
    joint: int,
    point_m: Floats,
    force: Floats,
    moment: Floats | None = None,
) -> Floats:
    """Return the acceleration under torques and a force and moment at a point of a link.

    Parameters and errors are those of `arm.newton_euler.forward_dynamics` and `outer_joint_torque`.

    Returns
    -------
    (n_sample, n_joint) [rad/s^2 or m/s^2]
    """
    q, dq, tau = motion_rows(arm, q=q, dq=dq, tau=tau)
    net = tau - touched_inverse_dynamics(arm, q, dq, np.zeros_like(q), joint, point_m, force, moment)
    return np.asarray(np.linalg.solve(mass_matrix(arm, q), net[..., None])[..., 0], dtype=np.float64)


@compiled
def point_motion(
    chain: Chain, R: Floats, p: Floats, dq: Floats, joint: int, point: Floats, axes: Floats, moving: Floats
) -> None:
    """Fill in where a point of link ``joint`` (from 0) is and how it moves, in the base frame.

    ``axes`` (3, 3) takes the link's axes as columns; ``moving`` (3, 3) the point's place and velocity and the
    link's angular velocity. R and p are as `arm.newton_euler.poses` fills them in.
    """
    base_axes(chain.parent, R, joint, axes)
    at, v, w = (point[0], point[1], point[2]), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    i = joint
    while i >= 0:  # from link to parent: how the point moves as seen from each, in its axes
        if chain.revolute[i]:
            v = (v[0] - at[1] * dq[i], v[1] + at[0] * dq[i], v[2])  # z x at
            w = (w[0], w[1], w[2] + dq[i])
        else:
            v = (v[0], v[1], v[2] + dq[i])
        at, v, w = turned(R[i], at), turned(R[i], v), turned(R[i], w)
        at = (at[0] + p[i, 0], at[1] + p[i, 1], at[2] + p[i, 2])
        i = chain.parent[i]
    for row in range(3):
        moving[0, row], moving[1, row], moving[2, row] = at[row], v[row], w[row]


@compiled
def add_outer_torque(
    chain: Chain, R: Floats, p: Floats, joint: int, point: Floats, f: Triple, m: Triple, tau: Floats
) -> None:
    """Add to ``tau`` what a force and moment on link ``joint`` (from 0) do at the joints.

    ``f`` and ``m`` act at ``point``, and like it are given in the link's joint-axis frame.
    """
    lever = cross((point[0], point[1], point[2]), f)
    m = (m[0] + lever[0], m[1] + lever[1], m[2] + lever[2])
    i = joint
    while i >= 0:
        tau[i] += m[2] if chain.revolute[i] else f[2]
        f, m = turned(R[i], f), turned(R[i], m)
        lever = cross((p[i, 0], p[i, 1], p[i, 2]), f)
        m = (m[0] + lever[0], m[1] + lever[1], m[2] + lever[2])
        i = chain.parent[i]


@compiled
def _outer_torques(chain: Chain, q: Floats, joint: int, point: Floats, wrench: Floats, tau: Floats) -> None:
    n = q.shape[1]
    R, p, axes, moving = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(q.shape[0]):
        poses(chain, q[k], R, p)
        point_motion(chain, R, p, np.zeros(n), joint, point, axes, moving)
        f, m = (wrench[k, 0], wrench[k, 1], wrench[k, 2]), (wrench[k, 3], wrench[k, 4], wrench[k, 5])
        back = np.ascontiguousarray(axes.T)
        add_outer_torque(chain, R, p, joint, point, turned(back, f), turned(back, m), tau[k])
