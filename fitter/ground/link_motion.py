"""How the links of a tree move in the world: pose, angular velocity and acceleration of each joint-axis frame."""

from dataclasses import dataclass

import numpy as np

from arm.chain import chain_of
from arm.kinematics import axis_frames
from arm.model import Arm, Floats
from arm.moving_base import BaseState


@dataclass(frozen=True)
class LinkMotion:
    """Of one link, in the world's axes.

    Attributes
    ----------
    R : (n_sample, 3, 3)
        Link to world.
    o : (n_sample, 3) [m]
        Origin of its joint-axis frame.
    omega, omega_dot : (n_sample, 3) [rad/s], [rad/s²]
    acceleration : (n_sample, 3) [m/s²]
        Of the origin, less gravity: what an accelerometer there would read.
    """

    R: Floats
    o: Floats
    omega: Floats
    omega_dot: Floats
    acceleration: Floats


def link_motions(arm: Arm, q: Floats, dq: Floats, ddq: Floats, base: BaseState) -> list[LinkMotion]:
    """Return the motion of every link.

    Parameters
    ----------
    arm : Arm
        ``gravity_m_s2`` is taken to be in the world.
    q, dq, ddq : (n_sample, n_joint) [rad or m, and derivatives]
    base : BaseState
    """
    revolute, frames = chain_of(arm).revolute, axis_frames(arm, q)
    R = np.einsum("nij,nljk->nlik", base.R, frames[..., :3, :3])
    o = np.einsum("nij,nlj->nli", base.R, frames[..., :3, 3]) + base.p[:, None]
    began = LinkMotion(base.R, base.p, base.omega, base.omega_dot, base.acceleration - np.array(arm.gravity_m_s2))
    found: list[LinkMotion] = []
    for i, parent in enumerate(arm.parents):
        before = found[parent] if parent >= 0 else began
        r, w, dw = o[:, i] - before.o, before.omega, before.omega_dot
        dv = before.acceleration + np.cross(dw, r) + np.cross(w, np.cross(w, r))
        z = R[:, i, :, 2]
        along, rate = ddq[:, i, None] * z, dq[:, i, None] * z
        if revolute[i]:
            w, dw = w + rate, dw + along + np.cross(w, rate)
        else:
            dv = dv + along + 2.0 * np.cross(w, rate)
        found.append(LinkMotion(R[:, i], o[:, i], w, dw, dv))
    return found
