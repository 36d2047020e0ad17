"""The torque as a linear function of the standard parameters: ``tau = Y(q, dq, ddq) p``.

Standard parameters, in this order: for each joint ``xx yy zz xy xz yz`` of the inertia tensor about the
joint-axis frame's origin, ``m*sx m*sy m*sz``, ``m``; then the viscous frictions ``D`` and the Coulomb
frictions ``fc`` of all joints.
"""

import numpy as np

from arm.chain import Chain, chain_of, motion_rows
from arm.model import Arm, Floats
from arm.newton_euler import poses, rigid_motion
from limbcal.compiled import compiled

INERTIAL = ("I{}xx", "I{}yy", "I{}zz", "I{}xy", "I{}xz", "I{}yz", "m{}*sx{}", "m{}*sy{}", "m{}*sz{}", "m{}")


def standard_names(n_joint: int) -> list[str]:
    """Return the names of the standard parameters, ``12 * n_joint`` of them."""
    numbers = range(1, n_joint + 1)
    inertial = [name.format(i, i) for i in numbers for name in INERTIAL]
    return inertial + [f"D{i}" for i in numbers] + [f"fc{i}" for i in numbers]


def standard_parameters(arm: Arm) -> Floats:
    """Return the arm's standard parameters.

    Returns
    -------
    (12 * n_joint,)
    """
    chain = chain_of(arm)
    return np.concatenate([chain.inertial.ravel(), chain.friction[:, 0], chain.friction[:, 1]])


def regressor(arm: Arm, q: Floats, dq: Floats, ddq: Floats) -> Floats:
    """Return Y with ``inverse_dynamics(arm, q, dq, ddq) = Y @ standard_parameters(arm)``.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity are used, its inertial parameters are not.
    q, dq, ddq : (n_sample, n_joint) [rad or m, and derivatives]

    Returns
    -------
    (n_sample, n_joint, 12 * n_joint)
    """
    q, dq, ddq = motion_rows(arm, q=q, dq=dq, ddq=ddq)
    n = arm.n_joint
    Y = np.zeros((len(q), n, 12 * n))
    _regressors(chain_of(arm), q, dq, ddq, Y)
    return Y


@compiled
def link_wrench(w: Floats, dw: Floats, dv: Floats, F: Floats) -> None:
    """Fill in F (6, 10): force (rows 0-2) and moment (3-5) of one link, linear in its ten parameters."""
    F[:, :] = 0.0
    wx, wy, wz = w
    # The moment of the inertia tensor: L(dw) + w x L(w), with L(u) I = [xx*ux + xy*uy + xz*uz, ...].
    for col, (a, b) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        F[3 + a, col] += dw[b]
        if a != b:
            F[3 + b, col] += dw[a]
        hx = (w[b] if a == 0 else 0.0) + (w[a] if b == 0 and a != b else 0.0)
        hy = (w[b] if a == 1 else 0.0) + (w[a] if b == 1 and a != b else 0.0)
        hz = (w[b] if a == 2 else 0.0) + (w[a] if b == 2 and a != b else 0.0)
        F[3, col] += wy * hz - wz * hy
        F[4, col] += wz * hx - wx * hz
        F[5, col] += wx * hy - wy * hx
    # The force of the first moment: dw x s + w x (w x s); its moment: s x dv.
    F[0, 6], F[0, 7], F[0, 8] = -(wy * wy + wz * wz), wx * wy - dw[2], wx * wz + dw[1]
    F[1, 6], F[1, 7], F[1, 8] = wx * wy + dw[2], -(wx * wx + wz * wz), wy * wz - dw[0]
    F[2, 6], F[2, 7], F[2, 8] = wx * wz - dw[1], wy * wz + dw[0], -(wx * wx + wy * wy)
    F[3, 7], F[3, 8] = dv[2], -dv[1]
    F[4, 6], F[4, 8] = -dv[2], dv[0]
    F[5, 6], F[5, 7] = dv[1], -dv[0]
    F[0, 9], F[1, 9], F[2, 9] = dv[0], dv[1], dv[2]


@compiled
def regressor_rows(
    chain: Chain,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    R: Floats,
    p: Floats,
    motion: Floats,
    F: Floats,
    Y: Floats,
) -> None:
    """Fill in the rows of one sample: Y (n_joint, 12 * n_joint), which must be zero where nothing acts.

    ``R`` (n, 3, 3), ``p`` (n, 3), ``motion`` (n, 3, 3) and ``F`` (6, 10) are room to work in.
    """
    n = q.size
    poses(chain, q, R, p)
    rigid_motion(chain, chain.gravity, R, p, dq, ddq, motion)
    for link in range(n):
        link_wrench(motion[link, 0], motion[link, 1], motion[link, 2], F)
        for joint in range(link, -1, -1):
            row = 5 if chain.revolute[joint] else 2
            for col in range(10):
                Y[joint, 10 * link + col] = F[row, col]
            if joint > 0:  # carry the wrench to the joint before
                T, x, y, z = R[joint], p[joint, 0], p[joint, 1], p[joint, 2]
                for col in range(10):
                    f0, f1, f2, m0, m1, m2 = F[0, col], F[1, col], F[2, col], F[3, col], F[4, col], F[5, col]
                    fx = T[0, 0] * f0 + T[0, 1] * f1 + T[0, 2] * f2
                    fy = T[1, 0] * f0 + T[1, 1] * f1 + T[1, 2] * f2
                    fz = T[2, 0] * f0 + T[2, 1] * f1 + T[2, 2] * f2
                    F[0, col], F[1, col], F[2, col] = fx, fy, fz
                    F[3, col] = T[0, 0] * m0 + T[0, 1] * m1 + T[0, 2] * m2 + y * fz - z * fy
                    F[4, col] = T[1, 0] * m0 + T[1, 1] * m1 + T[1, 2] * m2 + z * fx - x * fz
                    F[5, col] = T[2, 0] * m0 + T[2, 1] * m1 + T[2, 2] * m2 + x * fy - y * fx
    for i in range(n):
        Y[i, 10 * n + i] = dq[i]
        Y[i, 11 * n + i] = np.sign(dq[i])


@compiled
def _regressors(chain: Chain, q: Floats, dq: Floats, ddq: Floats, Y: Floats) -> None:
    n = q.shape[1]
    R, p, motion, F = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((6, 10))
    for k in range(q.shape[0]):
        regressor_rows(chain, q[k], dq[k], ddq[k], R, p, motion, F, Y[k])
