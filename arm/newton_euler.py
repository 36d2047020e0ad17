"""The Newton-Euler equations of section 4, both ways.

Everything is expressed in the links' joint-axis frames, so the offset between two frames is the far end of
one link and eq. (1) without its last factor. Three slips of the print are put right here (docs/errata.md):
rho is 1 for a joint that turns, the Coriolis term of a sliding joint is ``2 omega x z dq``, and ``v_dot``
belongs to the frame's origin. Force and moment at the tip are what acts on the arm there, not what the arm
passes on. On a tree a link hands its motion on to every joint that hangs on it, and gets the force and moment of
each; what is said of the link before is said of the parent.
"""

import math

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, chain_of, joint_rows, motion_rows, move
from arm.composite_bodies import mass_rows
from arm.model import Arm, Floats
from arm.sine_cosine import sines_cosines
from arm.triple import cross, turned, turned_back
from limbcal.compiled import borrowed, compiled
from limbcal.errors import DataError


def inverse_dynamics(
    arm: Arm,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    tip_force: Floats | None = None,
    tip_moment: Floats | None = None,
) -> Floats:
    """Return the joint torques of a motion, eq. (4), friction included.

    Parameters
    ----------
    arm : Arm
    q, dq, ddq : (n_sample, n_joint) [rad or m, and derivatives]
    tip_force, tip_moment : (n_sample, 3) or (3,), optional
        What acts on the arm at its tip, in the base frame [N], [N m].

    Returns
    -------
    (n_sample, n_joint) [N m or N]
        Torques; ``sgn(0)`` is 0, so a joint at rest shows no Coulomb friction.
    """
    q, dq, ddq = motion_rows(arm, q=q, dq=dq, ddq=ddq)
    wrench = tip_wrench(tip_force, tip_moment, len(q))
    tau = np.empty_like(q)
    sine, cosine = sines_cosines(q)
    _inverse_dynamics(chain_of(arm), q, cosine, sine, dq, ddq, wrench, tau)
    return tau


def mass_matrix(arm: Arm, q: Floats) -> Floats:
    """Return M(q) of eq. (4).

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_joint, n_joint) [kg m^2, kg m or kg]
    """
    rows = joint_rows(arm, "q", q)
    M = np.empty((*rows.shape, arm.n_joint))
    _mass_matrices(chain_of(arm), rows, M)
    return M


def bias_torque(arm: Arm, q: Floats, dq: Floats) -> Floats:
    """Return ``h + g + D dq + E`` of eq. (4): the torque of a motion without acceleration.

    Parameters
    ----------
    arm : Arm
    q, dq : (n_sample, n_joint) [rad or m, and derivative]

    Returns
    -------
    (n_sample, n_joint) [N m or N]
    """
    return inverse_dynamics(arm, q, dq, np.zeros_like(joint_rows(arm, "dq", dq)))


def forward_dynamics(
    arm: Arm,
    q: Floats,
    dq: Floats,
    tau: Floats,
    tip_force: Floats | None = None,
    tip_moment: Floats | None = None,
) -> Floats:
    """Return ``M^-1 (tau - h - g - D dq - E)``: the acceleration that torques cause (section 7, step 2).

    Parameters
    ----------
    arm : Arm
    q, dq, tau : (n_sample, n_joint)
    tip_force, tip_moment : (n_sample, 3) or (3,), optional
        What acts on the arm at its tip, in the base frame [N], [N m].

    Returns
    -------
    (n_sample, n_joint) [rad/s^2 or m/s^2]
        A joint at rest is taken to be free; whether it sticks is for `arm.simulation` to say.
    """
    q, dq, tau = motion_rows(arm, q=q, dq=dq, tau=tau)
    net = tau - inverse_dynamics(arm, q, dq, np.zeros_like(q), tip_force, tip_moment)
    return np.asarray(np.linalg.solve(mass_matrix(arm, q), net[..., None])[..., 0], dtype=np.float64)


def tip_wrench(force: Floats | None, moment: Floats | None, n_sample: int) -> Floats:
    """Return force and moment at the tip as one ``(n_sample, 6)`` array, zero where none is given.

    Raises
    ------
    DataError
        If a force or moment does not fit ``(n_sample, 3)``.
    """
    wrench = np.zeros((n_sample, 6))
    for name, part, given in (("tip_force", wrench[:, :3], force), ("tip_moment", wrench[:, 3:], moment)):
        if given is not None:
            if np.shape(given) not in ((3,), (n_sample, 3)):
                raise DataError(f"{name} has shape {np.shape(given)}, expected ({n_sample}, 3)")
            part[:] = given
    return wrench


@compiled
def rigid_motion(
    chain: Chain, gravity: Floats, R: Floats, p: Floats, dq: Floats, ddq: Floats, motion: Floats
) -> None:
    """Fill in omega, omega_dot and v_dot of every joint-axis frame, in itself: motion (n, 3, 3).

    The direct part of the recursion. ``v_dot`` starts as ``-g``, so it is the specific force.
    """
    w, dw, dv = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (-gravity[0], -gravity[1], -gravity[2])
    for i in range(dq.size):
        before = chain.parent[i]
        if before != i - 1:  # not the link that has just been left
            w, dw, dv = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (-gravity[0], -gravity[1], -gravity[2])
            if before >= 0:
                w = (motion[before, 0, 0], motion[before, 0, 1], motion[before, 0, 2])
                dw = (motion[before, 1, 0], motion[before, 1, 1], motion[before, 1, 2])
                dv = (motion[before, 2, 0], motion[before, 2, 1], motion[before, 2, 2])
        to_axis = (p[i, 0], p[i, 1], p[i, 2])
        swing = cross(dw, to_axis)
        pull = cross(w, cross(w, to_axis))
        dv = turned_back(
            R[i], (dv[0] + swing[0] + pull[0], dv[1] + swing[1] + pull[1], dv[2] + swing[2] + pull[2])
        )
        w, dw = turned_back(R[i], w), turned_back(R[i], dw)
        if chain.revolute[i]:  # rho = 1
            dw = (dw[0] + w[1] * dq[i], dw[1] - w[0] * dq[i], dw[2] + ddq[i])  # (R omega) x z dq + z ddq
            w = (w[0], w[1], w[2] + dq[i])
        else:
            dv = (dv[0] + 2.0 * w[1] * dq[i], dv[1] - 2.0 * w[0] * dq[i], dv[2] + ddq[i])  # 2 omega x z dq
        for row in range(3):
            motion[i, 0, row], motion[i, 1, row], motion[i, 2, row] = w[row], dw[row], dv[row]


@compiled
def rigid_torque(
    chain: Chain, R: Floats, p: Floats, motion: Floats, wrench: Floats, branch: Floats, tau: Floats
) -> None:
    """Fill in the torques of a motion without friction in its joints: the inverse part of the recursion.

    ``wrench`` (6,) is what the tip passes on, in frame n. In ``branch`` (n, 10) what branches pass on waits until
    their parent's turn comes; it is zero before and after.
    """
    n, branched = tau.size, False
    f, m = (wrench[0], wrench[1], wrench[2]), (wrench[3], wrench[4], wrench[5])
    at = (chain.geometry[n - 1, 1], 0.0, 0.0)  # the tip is at the far end of the last link
    for i in range(n - 1, -1, -1):
        w, dw, dv = motion[i, 0], motion[i, 1], motion[i, 2]
        W, dW, dV = (w[0], w[1], w[2]), (dw[0], dw[1], dw[2]), (dv[0], dv[1], dv[2])
        xx, yy, zz, xy, xz, yz, sx, sy, sz, mass = chain.inertial[i]
        s = (sx, sy, sz)  # m s
        spin = (
            xx * w[0] + xy * w[1] + xz * w[2],
            xy * w[0] + yy * w[1] + yz * w[2],
            xz * w[0] + yz * w[1] + zz * w[2],
        )
        gyro, lever, arm_of_f = cross(W, spin), cross(s, dV), cross(at, f)
        drag = chain.drag[i]
        if drag != 0.0:
            drag *= math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
        swing, pull = cross(dW, s), cross(W, cross(W, s))
        own_m = (
            gyro[0] + lever[0] + xx * dw[0] + xy * dw[1] + xz * dw[2] + drag * w[0],
            gyro[1] + lever[1] + xy * dw[0] + yy * dw[1] + yz * dw[2] + drag * w[1],
            gyro[2] + lever[2] + xz * dw[0] + yz * dw[1] + zz * dw[2] + drag * w[2],
        )
        # what is handed on comes last: the next link waits for it, and for nothing else of this one
        m = (m[0] + arm_of_f[0] + own_m[0], m[1] + arm_of_f[1] + own_m[1], m[2] + arm_of_f[2] + own_m[2])
        f = (
            f[0] + (mass * dv[0] + swing[0] + pull[0]),
            f[1] + (mass * dv[1] + swing[1] + pull[1]),
            f[2] + (mass * dv[2] + swing[2] + pull[2]),
        )
        if branched:
            f = (f[0] + branch[i, 0], f[1] + branch[i, 1], f[2] + branch[i, 2])
            m = (m[0] + branch[i, 3], m[1] + branch[i, 4], m[2] + branch[i, 5])
            for k in range(6):
                branch[i, k] = 0.0
        tau[i] = m[2] if chain.revolute[i] else f[2]
        at = (p[i, 0], p[i, 1], p[i, 2])  # where the link before takes it over
        f, m = turned(R[i], f), turned(R[i], m)
        before = chain.parent[i]
        if before != i - 1:
            if before >= 0:
                lever, branched = cross(at, f), True
                for row in range(3):
                    branch[before, row] += f[row]
                    branch[before, 3 + row] += m[row] + lever[row]
            f, m = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


@compiled
def tip_load(parent: NDArray[np.int64], R: Floats, wrench: Floats, axes: Floats, out: Floats) -> None:
    """Turn what acts on the tip, in the base frame, into what link n passes on, in frame n.

    ``axes`` (3, 3) is room to work in: it takes frame n's axes as columns.
    """
    out[:] = 0.0
    if not wrench.any():
        return
    base_axes(parent, R, R.shape[0] - 1, axes)
    for part in (0, 3):
        for row in range(3):
            for k in range(3):
                out[part + row] -= axes[k, row] * wrench[part + k]


@compiled
def base_axes(parent: NDArray[np.int64], R: Floats, link: int, axes: Floats) -> None:
    """Fill in a link's axes in the base frame, as columns: the product of all R up to it."""
    axes[:] = R[link]
    before = parent[link]
    while before >= 0:
        for col in range(3):
            x, y, z = turned(R[before], (axes[0, col], axes[1, col], axes[2, col]))
            axes[0, col], axes[1, col], axes[2, col] = x, y, z
        before = parent[before]


@compiled
def _inverse_dynamics(
    chain: Chain, q: Floats, cosine: Floats, sine: Floats, dq: Floats, ddq: Floats, wrench: Floats, tau: Floats
) -> None:
    n = q.shape[1]
    R, p, motion = chain.zero_R.copy(), chain.zero_p.copy(), np.empty((n, 3, 3))
    branch, axes, tip = np.zeros((n, 10)), np.empty((3, 3)), np.empty(6)
    _torques(borrowed(chain), q, cosine, sine, dq, ddq, wrench, R, p, motion, branch, axes, tip, tau)


@compiled
def _torques(
    chain: Chain,
    q: Floats,
    cosine: Floats,
    sine: Floats,
    dq: Floats,
    ddq: Floats,
    wrench: Floats,
    R: Floats,
    p: Floats,
    motion: Floats,
    branch: Floats,
    axes: Floats,
    tip: Floats,
    tau: Floats,
) -> None:
    """Do the work of `_inverse_dynamics`, which makes the arrays: a loop beside them takes a third longer."""
    for k in range(q.shape[0]):
        move(chain, q[k], cosine[k], sine[k], R, p)
        rigid_motion(chain, chain.gravity, R, p, dq[k], ddq[k], motion)
        tip_load(chain.parent, R, wrench[k], axes, tip)
        rigid_torque(chain, R, p, motion, tip, branch, tau[k])
        for i in range(q.shape[1]):  # D dq + f sgn(dq)
            tau[k, i] += chain.friction[i, 0] * dq[k, i] + chain.friction[i, 1] * np.sign(dq[k, i])


@compiled
def _mass_matrices(chain: Chain, q: Floats, M: Floats) -> None:
    sine, cosine = sines_cosines(q)
    R, p, branch = chain.zero_R.copy(), chain.zero_p.copy(), np.zeros((q.shape[1], 10))
    lent = borrowed(chain)  # to count references to its arrays at every sample takes longer than the matrix
    for k in range(q.shape[0]):
        move(lent, q[k], cosine[k], sine[k], R, p)
        mass_rows(lent, R, p, branch, M[k])
