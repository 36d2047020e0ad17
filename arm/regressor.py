"""The torque as a linear function of the standard parameters: ``tau = Y(q, dq, ddq) p``.

Standard parameters, in this order: for each joint ``xx yy zz xy xz yz`` of the inertia tensor about the
joint-axis frame's origin, ``m*sx m*sy m*sz``, ``m``; then the viscous frictions ``D`` and the Coulomb
frictions ``fc`` of all joints.

A torque about joint j is the power that a link's force and moment would have if joint j alone moved at unit
speed. That unit motion is carried outwards from link to link, six numbers a joint; only joints on a link's way to
the base move it. Samples are taken `arm.regressor_lanes.LANES` at a time.
"""

import numpy as np

from arm.chain import Chain, chain_of, motion_rows
from arm.model import Arm, Floats
from arm.regressor_lanes import (
    LANES,
    N_STATE,
    begin_lanes,
    carry_lanes,
    fill_lanes,
    link_powers_lanes,
    move_lanes,
    rigid_motion_lanes,
)
from arm.sine_cosine import sines_cosines
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
    R0, p0 = chain.zero_R, chain.zero_p
    R, p, state = np.empty((n, 9, LANES)), np.empty((n, 3, LANES)), np.empty((n, N_STATE, LANES))
    motion, unit = np.empty((n + 1, 9, LANES)), np.empty((n, n, 6, LANES))
    carried, powers = np.empty((6, LANES)), np.empty((10, LANES))
    begin_lanes(chain, R0, p0, R, p, motion, unit)
    sine, cosine = sines_cosines(q)
    for first in range(0, n_sample, LANES):
        used = min(LANES, n_sample - first)
        fill_lanes(chain.revolute, first, used, q, cosine, sine, dq, ddq, state)
        for link in range(n):
            turns, on = chain.revolute[link], chain.parent[link] if chain.parent[link] >= 0 else n
            move_lanes(turns, link, state, R0, p0, R, p)
            rigid_motion_lanes(turns, link, on, state, R, p, motion)
            joint = link
            while joint >= 0:
                if joint < link:  # from the link before, moved by this joint alone
                    carry_lanes(link, on, joint, R, p, unit, carried)
                link_powers_lanes(link, joint, motion, unit, powers)
                for b in range(used):
                    for k in range(10):
                        Y[first + b, joint, 10 * link + k] = powers[k, b]
                joint = chain.parent[joint]
        for s in range(first, first + used):
            for joint in range(n):
                Y[s, joint, 10 * n + joint] = dq[s, joint]
                Y[s, joint, 11 * n + joint] = np.sign(dq[s, joint])
