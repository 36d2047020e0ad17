"""The Newton-Euler equations of section 4, both ways.

Everything is expressed in the links' joint-axis frames, so the offset between two frames is the far end of
one link and eq. (1) without its last factor. Three slips of the print are put right here (docs/errata.md):
rho is 1 for a joint that turns, the Coriolis term of a sliding joint is ``2 omega x z dq``, and ``v_dot``
belongs to the frame's origin. Force and moment at the tip are what acts on the arm there, not what the arm passes on.
"""

import numpy as np

from arm.chain import Chain, chain_of, joint_rows, link_step
from arm.model import Arm, Floats
from limbcal.compiled import compiled
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
    q, dq, ddq = joint_rows(arm, "q", q), joint_rows(arm, "dq", dq), joint_rows(arm, "ddq", ddq)
    wrench = tip_wrench(tip_force, tip_moment, len(q))
    tau = np.empty_like(q)
    _inverse_dynamics(chain_of(arm), q, dq, ddq, wrench, tau)
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
    rest = np.zeros_like(joint_rows(arm, "q", q))
    bias = inverse_dynamics(arm, q, dq, rest, tip_force, tip_moment)
    net = joint_rows(arm, "tau", tau) - bias
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
def cross(a: Floats, b: Floats, out: Floats) -> None:
    """Fill in ``a x b``."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@compiled
def poses(chain: Chain, q: Floats, R: Floats, p: Floats) -> None:
    """Fill in every joint-axis frame's pose in the one before it: R (n, 3, 3), p (n, 3)."""
    for i in range(q.size):
        alpha, _, d, beta, offset = chain.geometry[i]
        link_step(chain.revolute[i], alpha, d, beta, offset, q[i], R[i], p[i])
        if i > 0:
            p[i, 0] += chain.geometry[i - 1, 1]


@compiled
def rigid_motion(
    chain: Chain, gravity: Floats, R: Floats, p: Floats, dq: Floats, ddq: Floats, motion: Floats
) -> None:
    """Fill in omega, omega_dot and v_dot of every joint-axis frame, in itself: motion (n, 3, 3).

    The direct part of the recursion. ``v_dot`` starts as ``-g``, so it is the specific force.
    """
    w0, dw0, dv0, u, v = np.zeros(3), np.zeros(3), -gravity, np.empty(3), np.empty(3)
    for i in range(dq.size):
        w, dw, dv = motion[i, 0], motion[i, 1], motion[i, 2]
        cross(w0, p[i], u)
        cross(w0, u, v)
        cross(dw0, p[i], u)
        u += v
        u += dv0
        for row in range(3):
            w[row] = R[i, 0, row] * w0[0] + R[i, 1, row] * w0[1] + R[i, 2, row] * w0[2]
            dw[row] = R[i, 0, row] * dw0[0] + R[i, 1, row] * dw0[1] + R[i, 2, row] * dw0[2]
            dv[row] = R[i, 0, row] * u[0] + R[i, 1, row] * u[1] + R[i, 2, row] * u[2]
        if chain.revolute[i]:
            dw[0] += w[1] * dq[i]  # (R omega) x z dq
            dw[1] -= w[0] * dq[i]
            dw[2] += ddq[i]
            w[2] += dq[i]
        else:
            dv[0] += 2.0 * w[1] * dq[i]  # 2 omega x z dq
            dv[1] -= 2.0 * w[0] * dq[i]
            dv[2] += ddq[i]
        w0, dw0, dv0 = w, dw, dv


@compiled
def rigid_torque(
    chain: Chain, R: Floats, p: Floats, motion: Floats, wrench: Floats, load: Floats, tau: Floats
) -> None:
    """Fill in the torques of a motion without friction: the inverse part of the recursion.

    ``wrench`` is what the tip passes on, in frame n; ``load`` (2, 3) is room for force and moment.
    """
    n = tau.size
    f, m = load[0], load[1]
    f[:], m[:] = wrench[:3], wrench[3:]
    u, v, force, moment = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    u[0], u[1], u[2] = chain.geometry[n - 1, 1], 0.0, 0.0  # the tip is at the far end of the last link
    cross(u, f, v)
    m += v
    for i in range(n - 1, -1, -1):
        w, dw, dv = motion[i, 0], motion[i, 1], motion[i, 2]
        xx, yy, zz, xy, xz, yz, sx, sy, sz, mass = chain.inertial[i]
        if i < n - 1:  # turn what the next link asks for into this link's frame
            for row in range(3):
                force[row] = R[i + 1, row, 0] * f[0] + R[i + 1, row, 1] * f[1] + R[i + 1, row, 2] * f[2]
                moment[row] = R[i + 1, row, 0] * m[0] + R[i + 1, row, 1] * m[1] + R[i + 1, row, 2] * m[2]
            cross(p[i + 1], force, u)
            f[:] = force
            m[:] = moment + u
        force[0], force[1], force[2] = sx, sy, sz  # m s
        cross(w, force, u)
        cross(w, u, v)
        cross(dw, force, u)
        f += mass * dv + u + v
        cross(force, dv, u)
        m += u
        u[0] = xx * dw[0] + xy * dw[1] + xz * dw[2]
        u[1] = xy * dw[0] + yy * dw[1] + yz * dw[2]
        u[2] = xz * dw[0] + yz * dw[1] + zz * dw[2]
        m += u
        u[0] = xx * w[0] + xy * w[1] + xz * w[2]
        u[1] = xy * w[0] + yy * w[1] + yz * w[2]
        u[2] = xz * w[0] + yz * w[1] + zz * w[2]
        cross(w, u, v)
        m += v
        tau[i] = m[2] if chain.revolute[i] else f[2]


@compiled
def tip_load(R: Floats, wrench: Floats, out: Floats) -> None:
    """Turn what acts on the tip, in the base frame, into what link n passes on, in frame n."""
    for part in (0, 3):
        out[part : part + 3] = -wrench[part : part + 3]
        for i in range(R.shape[0]):
            x, y, z = out[part], out[part + 1], out[part + 2]
            for row in range(3):
                out[part + row] = R[i, 0, row] * x + R[i, 1, row] * y + R[i, 2, row] * z


@compiled
def mass_columns(chain: Chain, R: Floats, p: Floats, motion: Floats, load: Floats, M: Floats) -> None:
    """Fill in the mass matrix, one column a unit acceleration."""
    n = M.shape[0]
    still, unit, none = np.zeros(n), np.zeros(n), np.zeros(6)
    gravity = np.zeros(3)
    for i in range(n):
        unit[i] = 1.0
        rigid_motion(chain, gravity, R, p, still, unit, motion)
        rigid_torque(chain, R, p, motion, none, load, M[i])
        unit[i] = 0.0


@compiled
def _inverse_dynamics(chain: Chain, q: Floats, dq: Floats, ddq: Floats, wrench: Floats, tau: Floats) -> None:
    n = q.shape[1]
    R, p, motion = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3, 3))
    load, tip = np.empty((2, 3)), np.empty(6)
    for k in range(q.shape[0]):
        poses(chain, q[k], R, p)
        rigid_motion(chain, chain.gravity, R, p, dq[k], ddq[k], motion)
        tip_load(R, wrench[k], tip)
        rigid_torque(chain, R, p, motion, tip, load, tau[k])
        for i in range(n):  # D dq + f sgn(dq)
            tau[k, i] += chain.friction[i, 0] * dq[k, i] + chain.friction[i, 1] * np.sign(dq[k, i])


@compiled
def _mass_matrices(chain: Chain, q: Floats, M: Floats) -> None:
    n = q.shape[1]
    R, p, motion, load = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((2, 3))
    for k in range(q.shape[0]):
        poses(chain, q[k], R, p)
        mass_columns(chain, R, p, motion, load, M[k])
