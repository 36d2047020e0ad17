"""The arm as plain arrays, which is all that compiled kernels know of it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arm.model import Arm, Floats, Joint
from limbcal.compiled import compiled, inlined
from limbcal.errors import DataError


class Chain(NamedTuple):
    """The numbers of an arm, one row a joint.

    Attributes
    ----------
    revolute : (n,) bool
        The paper's rho as it must be: true where the joint turns.
    geometry : (n, 5)
        alpha, a, d, beta, theta offset.
    inertial : (n, 10)
        xx yy zz xy xz yz of the inertia tensor, m*sx m*sy m*sz, m; about the joint-axis frame's origin.
    friction : (n, 3)
        viscous, Coulomb, static.
    gravity : (3,)
        In the base frame.
    drag : (n,)
        With which the air resists a link's turning [N m s^2/rad^2].
    parent : (n,) int64
        The link that each joint hangs on, from 0, always an earlier one; -1: the base.
    hang : (n, 4)
        Where on it: the share of the parent's a (1 at its far end), and x, y, z beyond that [m], in the parent's
        joint-axis frame. `hang_on` adds them up.
    zero_R : (n, 3, 3)
    zero_p : (n, 3) [m]
        The pose of each joint-axis frame in its parent's where q is zero: what eq. (1) has of constants.
    """

    revolute: NDArray[np.bool_]
    geometry: Floats
    inertial: Floats
    friction: Floats
    gravity: Floats
    drag: Floats
    parent: NDArray[np.int64]
    hang: Floats
    zero_R: Floats
    zero_p: Floats


def chain_of(arm: Arm) -> Chain:
    """Return the arm's numbers as arrays."""
    geometry = np.array([[j.alpha_rad, j.a_m, j.d_m, j.beta_rad, j.theta_offset_rad] for j in arm.joints])
    parent = np.array(arm.parents, dtype=np.int64)
    hang = np.array([_hang(joint, on) for joint, on in zip(arm.joints, arm.parents, strict=True)])
    zero_R, zero_p = np.empty((arm.n_joint, 3, 3)), np.empty((arm.n_joint, 3))
    _zero_poses(geometry, parent, hang, zero_R, zero_p)
    return Chain(
        np.array([joint.type == "revolute" for joint in arm.joints]),
        geometry,
        np.array(
            [
                [*j.link.inertia_kg_m2, *(j.link.mass_kg * s for s in j.link.com_m), j.link.mass_kg]
                for j in arm.joints
            ]
        ),
        np.array([[j.friction.viscous_N_m_s, j.friction.coulomb_N_m, j.friction.static_N_m] for j in arm.joints]),
        np.array(arm.gravity_m_s2, dtype=float),
        np.array([joint.link.air_drag_N_m_s2 or 0.0 for joint in arm.joints]),
        parent,
        hang,
        zero_R,
        zero_p,
    )


def _hang(joint: Joint, parent: int) -> tuple[float, float, float, float]:
    if joint.parent_position_m is not None:
        return (0.0, *joint.parent_position_m)
    return (1.0 if parent >= 0 else 0.0, 0.0, 0.0, 0.0)


def joint_rows(arm: Arm, name: str, values: ArrayLike) -> Floats:
    """Return joint values as a contiguous ``(n_sample, n_joint)`` array; one row may come as ``(n_joint,)``.

    Raises
    ------
    DataError
        If the last dimension is not the arm's number of joints.
    """
    rows = np.atleast_2d(np.ascontiguousarray(values, dtype=float))
    if rows.ndim != 2 or rows.shape[1] != arm.n_joint:
        raise DataError(f"{name} has shape {np.shape(values)}, expected (n_sample, {arm.n_joint})")
    return rows


def motion_rows(arm: Arm, **columns: ArrayLike) -> list[Floats]:
    """Return several joint values as `joint_rows`, of as many samples each: kernels don't look again.

    Raises
    ------
    DataError
        If a shape does not fit the arm or the first of them.
    """
    rows = [joint_rows(arm, name, values) for name, values in columns.items()]
    first = next(iter(columns))
    for name, found in zip(columns, rows, strict=True):
        if len(found) != len(rows[0]):
            raise DataError(f"{name} has {len(found)} samples and {first} has {len(rows[0])}; expected as many")
    return rows


@compiled
def link_step(
    revolute: bool, alpha: float, d: float, beta: float, theta_offset: float, q: float, R: Floats, p: Floats
) -> None:
    """Fill in the pose of a joint-axis frame as seen from where the joint hangs on its parent.

    That is eq. (1) without its last factor: Rot(y, beta) Rot(x, alpha) Trans(0, 0, d) Rot(z, theta).
    """
    theta = theta_offset
    if revolute:
        theta += q
    else:
        d += q
    ca, sa = math.cos(alpha), math.sin(alpha)
    cb, sb = math.cos(beta), math.sin(beta)
    c, s = math.cos(theta), math.sin(theta)
    R[0, 0], R[0, 1], R[0, 2] = cb * c + sa * sb * s, c * sa * sb - cb * s, ca * sb  # eq. (1)
    R[1, 0], R[1, 1], R[1, 2] = ca * s, ca * c, -sa
    R[2, 0], R[2, 1], R[2, 2] = -c * sb + cb * sa * s, cb * c * sa + sb * s, ca * cb
    p[0], p[1], p[2] = d * ca * sb, -d * sa, d * ca * cb


@compiled
def hang_on(geometry: Floats, parent: NDArray[np.int64], hang: Floats, i: int, p: Floats) -> None:
    """Add to ``p`` where joint ``i`` hangs on its parent, in the parent's joint-axis frame."""
    if parent[i] >= 0:
        p[0] += hang[i, 0] * geometry[parent[i], 1]
    for row in range(3):
        p[row] += hang[i, 1 + row]


@compiled
def _zero_poses(geometry: Floats, parent: NDArray[np.int64], hang: Floats, R: Floats, p: Floats) -> None:
    for i in range(parent.size):
        alpha, _, d, beta, offset = geometry[i]
        link_step(True, alpha, d, beta, offset, 0.0, R[i], p[i])
        hang_on(geometry, parent, hang, i, p[i])


@inlined
def poses(chain: Chain, q: Floats, R: Floats, p: Floats) -> None:
    """Fill in every joint-axis frame's pose in its parent's: R (n, 3, 3), p (n, 3)."""
    for i in range(q.size):
        if chain.revolute[i]:
            turn_by(chain.zero_R[i], math.cos(q[i]), math.sin(q[i]), R[i])
            for row in range(3):
                R[i, row, 2], p[i, row] = chain.zero_R[i, row, 2], chain.zero_p[i, row]
        else:
            for row in range(3):
                for col in range(3):
                    R[i, row, col] = chain.zero_R[i, row, col]
                p[i, row] = chain.zero_p[i, row] + q[i] * chain.zero_R[i, row, 2]


@inlined
def move(chain: Chain, q: Floats, cosine: Floats, sine: Floats, R: Floats, p: Floats) -> None:
    """Do what `poses` does where R and p have been of the same chain, from cosines and sines of q.

    Where there are many samples these are so evaluated all at once, and what does not change is left alone.
    """
    for i in range(q.size):
        if chain.revolute[i]:
            turn_by(chain.zero_R[i], cosine[i], sine[i], R[i])
        else:
            for row in range(3):
                p[i, row] = chain.zero_p[i, row] + q[i] * chain.zero_R[i, row, 2]


@inlined
def turn_by(R0: Floats, cosine: float, sine: float, R: Floats) -> None:
    """Fill in the first two columns of ``R0 Rot(z, q)``; the third is that of ``R0``."""
    for row in range(3):
        x, y = R0[row, 0], R0[row, 1]
        R[row, 0], R[row, 1] = cosine * x + sine * y, cosine * y - sine * x
