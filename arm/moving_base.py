"""Inverse dynamics, eq. (4), of an arm whose base is carried about, with outer wrenches on any link.

The recursion of section 4, over all samples at once and in frame 0's axes. The base's turn begins it, where
`arm.newton_euler` begins at rest; its acceleration adds to that of gravity. `arm.newton_euler` is held against it
in tests.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.chain import chain_of, motion_rows
from arm.kinematics import axis_frames
from arm.model import Arm, Floats
from limbcal.errors import DataError


@dataclass(frozen=True)
class BaseState:
    """How frame 0 moves in the world.

    Attributes
    ----------
    R : (n_sample, 3, 3)
        Frame 0 to world.
    p : (n_sample, 3) [m]
    omega, omega_dot : (n_sample, 3) [rad/s], [rad/s²]
        In the world's axes.
    acceleration : (n_sample, 3) [m/s²]
        Of its origin.
    """

    R: Floats
    p: Floats
    omega: Floats
    omega_dot: Floats
    acceleration: Floats


@dataclass(frozen=True)
class OuterWrench:
    """What acts on a link from outside, in the world.

    Attributes
    ----------
    joint : int
        Which link, counted from 1.
    point_m : (n_sample, 3)
        Where the force acts.
    force, moment : (n_sample, 3) [N], [N m]
    """

    joint: int
    point_m: Floats
    force: Floats
    moment: Floats


def standing_base(n_sample: int) -> BaseState:
    """Return a base that stands in the world's origin."""
    nothing = np.zeros((n_sample, 3))
    return BaseState(np.tile(np.eye(3), (n_sample, 1, 1)), nothing, nothing, nothing, nothing)


def carried_inverse_dynamics(
    arm: Arm, q: Floats, dq: Floats, ddq: Floats, base: BaseState, wrenches: Sequence[OuterWrench] = ()
) -> Floats:
    """Return the joint torques of a motion, friction included.

    Parameters
    ----------
    arm : Arm
        ``gravity_m_s2`` is taken to be in the world.
    q, dq, ddq : (n_sample, n_joint) [rad or m, and derivatives]
    base : BaseState
    wrenches : sequence of OuterWrench

    Returns
    -------
    (n_sample, n_joint) [N m or N]

    Raises
    ------
    DataError
        If a shape or a link does not fit.
    """
    q, dq, ddq = motion_rows(arm, q=q, dq=dq, ddq=ddq)
    if len(base.p) != len(q):
        raise DataError(f"the base has {len(base.p)} samples and the joints {len(q)}; expected as many")
    chain, n = chain_of(arm), arm.n_joint
    frames = axis_frames(arm, q)
    R, o = frames[..., :3, :3], frames[..., :3, 3]
    w, dw = _in_base(base, base.omega), _in_base(base, base.omega_dot)
    dv = _in_base(base, base.acceleration - np.array(arm.gravity_m_s2))  # as if the base rose against gravity
    nothing = np.zeros((len(q), 3))
    moving = {-1: (nothing, w, dw, dv)}  # origin, omega, omega_dot and v_dot of the base and of every link
    force, moment = np.empty((n, len(q), 3)), np.empty((n, len(q), 3))
    for i, parent in enumerate(arm.parents):
        z = R[:, i, :, 2]
        there, w, dw, dv = moving[parent]
        r = o[:, i] - there
        dv = dv + np.cross(dw, r) + np.cross(w, np.cross(w, r))
        along, rate = ddq[:, i, None] * z, dq[:, i, None] * z
        if chain.revolute[i]:
            dw = dw + along + np.cross(w, rate)
            w = w + rate
        else:
            dv = dv + along + 2.0 * np.cross(w, rate)
        moving[i] = o[:, i], w, dw, dv
        force[i], moment[i] = _link_load(chain.inertial[i], chain.drag[i], R[:, i], w, dw, dv)
    for wrench in wrenches:
        if not 1 <= wrench.joint <= n:
            raise DataError(f"joint is {wrench.joint}, expected one of 1 to {n}")
        k = wrench.joint - 1
        f, at = _in_base(base, wrench.force), _in_base(base, wrench.point_m - base.p)
        force[k] -= f
        moment[k] -= _in_base(base, wrench.moment) + np.cross(at - o[:, k], f)
    tau = np.empty_like(q)
    for i, parent in reversed([*enumerate(arm.parents)]):
        tau[:, i] = np.einsum("ni,ni->n", R[:, i, :, 2], moment[i] if chain.revolute[i] else force[i])
        if parent >= 0:
            force[parent] += force[i]
            moment[parent] += moment[i] + np.cross(o[:, i] - o[:, parent], force[i])
    return np.asarray(tau + chain.friction[:, 0] * dq + chain.friction[:, 1] * np.sign(dq))


def _in_base(base: BaseState, x: Floats) -> Floats:
    """Return vectors of the world in frame 0's axes, (n_sample, 3)."""
    return np.asarray(np.einsum("nji,nj->ni", base.R, x))


def _link_load(
    inertial: Floats, drag: float, R: Floats, w: Floats, dw: Floats, dv: Floats
) -> tuple[Floats, Floats]:
    """Return the force and the moment about its joint-axis frame's origin that move a link."""
    xx, yy, zz, xy, xz, yz, *first, mass = inertial
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    inertia = R @ tensor @ R.transpose(0, 2, 1)
    s = R @ np.array(first)
    force = mass * dv + np.cross(dw, s) + np.cross(w, np.cross(w, s))
    spin = np.einsum("nij,nj->ni", inertia, w)
    moment = np.einsum("nij,nj->ni", inertia, dw) + np.cross(w, spin) + np.cross(s, dv)
    return force, moment + drag * np.linalg.norm(w, axis=1, keepdims=True) * w
