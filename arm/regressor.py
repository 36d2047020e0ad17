"""The torque as a linear function of the standard parameters: ``tau = Y(q, dq, ddq) p``.

Standard parameters, in this order: for each joint ``xx yy zz xy xz yz`` of the inertia tensor about the
joint-axis frame's origin, ``m*sx m*sy m*sz``, ``m``; then the viscous frictions ``D`` and the Coulomb
frictions ``fc`` of all joints.

A torque about joint j is the power that a link's force and moment would have if joint j alone moved at unit
speed. That unit motion is carried outwards from link to link, six numbers a joint; only joints on a link's way to
the base move it.
"""

import numpy as np

from arm.chain import Chain, chain_of, motion_rows
from arm.model import Arm, Floats
from arm.newton_euler import move, poses, rigid_motion
from arm.triple import Triple, cross, turned_back
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
    torque_rows(chain_of(arm), q, dq, ddq, Y)
    return Y


@compiled
def torque_rows(chain: Chain, q: Floats, dq: Floats, ddq: Floats, Y: Floats) -> None:
    """Fill in the rows of some samples: Y (n_sample, n_joint, 12 * n_joint), which must begin as zeros."""
    n_sample, n = q.shape
    R0, p0 = np.empty((n, 3, 3)), np.empty((n, 3))
    poses(chain, np.zeros(n), R0, p0)
    R, p, motion, unit = R0.copy(), p0.copy(), np.empty((n, 3, 3)), np.empty((n, n, 6))
    cosine, sine = np.cos(q), np.sin(q)
    for s in range(n_sample):
        move(chain.revolute, q[s], cosine[s], sine[s], R0, p0, R, p)
        rigid_motion(chain, chain.gravity, R, p, dq[s], ddq[s], motion)
        for link in range(n):
            w = (motion[link, 0, 0], motion[link, 0, 1], motion[link, 0, 2])
            dw = (motion[link, 1, 0], motion[link, 1, 1], motion[link, 1, 2])
            dv = (motion[link, 2, 0], motion[link, 2, 1], motion[link, 2, 2])
            at, turns = (p[link, 0], p[link, 1], p[link, 2]), 1.0 if chain.revolute[link] else 0.0
            joint, before = link, chain.parent[link]
            while joint >= 0:
                along, about = (0.0, 0.0, 1.0 - turns), (0.0, 0.0, turns)
                if joint < link:  # from the link before, moved by this joint alone
                    along = (unit[before, joint, 0], unit[before, joint, 1], unit[before, joint, 2])
                    about = (unit[before, joint, 3], unit[before, joint, 4], unit[before, joint, 5])
                    x = cross(about, at)
                    along = turned_back(R[link], (along[0] + x[0], along[1] + x[1], along[2] + x[2]))
                    about = turned_back(R[link], about)
                for k in range(3):
                    unit[link, joint, k], unit[link, joint, 3 + k] = along[k], about[k]
                link_powers(w, dw, dv, along, about, Y[s, joint], 10 * link)
                joint = chain.parent[joint]
        for joint in range(n):
            Y[s, joint, 10 * n + joint] = dq[s, joint]
            Y[s, joint, 11 * n + joint] = np.sign(dq[s, joint])


@compiled
def link_powers(w: Triple, dw: Triple, dv: Triple, along: Triple, about: Triple, out: Floats, at: int) -> None:
    """Fill in, from ``at`` on, the power of a link's wrench in a unit motion, for its ten parameters.

    The link moves with ``w, dw, dv`` and the unit motion has the velocity ``along`` at the link's origin and
    the angular velocity ``about``. With f = m dv + dw x s + w x (w x s) and
    n = I dw + w x I w + s x dv (section 4; s is the first moment) the power is along . f + about . n.
    """
    gyro = cross(about, w)  # about . (w x I w) = (about x w) . I w
    out[at] = about[0] * dw[0] + gyro[0] * w[0]
    out[at + 1] = about[1] * dw[1] + gyro[1] * w[1]
    out[at + 2] = about[2] * dw[2] + gyro[2] * w[2]
    out[at + 3] = about[0] * dw[1] + about[1] * dw[0] + gyro[0] * w[1] + gyro[1] * w[0]
    out[at + 4] = about[0] * dw[2] + about[2] * dw[0] + gyro[0] * w[2] + gyro[2] * w[0]
    out[at + 5] = about[1] * dw[2] + about[2] * dw[1] + gyro[1] * w[2] + gyro[2] * w[1]
    lever, swing, pull = cross(dv, about), cross(along, dw), cross(w, cross(w, along))
    for k in range(3):
        out[at + 6 + k] = lever[k] + swing[k] + pull[k]
    out[at + 9] = along[0] * dv[0] + along[1] * dv[1] + along[2] * dv[2]
