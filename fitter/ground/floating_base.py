"""The floating base of a tree, the bodies that hang on it, and the six equations that need no torque.

What the ground does to the tree, force and moment about the base link's origin, is what moves all its bodies:
``sum_i wrench_i(theta_i) = w``. These are the six base rows of eq. (4) (Venture, Ayusawa and Nakamura 2009),
written as force and moment in the world's axes and not along the base's joints, whose axes may fall together.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.chain import chain_of
from arm.model import Arm, Floats
from arm.physical_links import is_possible
from arm.regressor import standard_parameters
from fitter.ground.link_motion import LinkMotion
from limbcal.errors import ConfigError

#: Joints of a floating base: three that slide, three that turn.
N_FREE = 6


@dataclass(frozen=True)
class FloatingBase:
    """Which joints nothing drives, and which links have a mass.

    Attributes
    ----------
    joints : (6,) tuple of int
        From 0, from the world outwards.
    bodies : tuple of int
        Links with a mass, from 0, the base link first.
    links : (n_body, 10)
        Their standard parameters.
    """

    joints: tuple[int, ...]
    bodies: tuple[int, ...]
    links: Floats


def floating_base(arm: Arm) -> FloatingBase:
    """Return the floating base of an arm.

    Raises
    ------
    ConfigError
        If it has none, or a link has a mass that no body can have.
    """
    links = standard_parameters(arm)[: 10 * arm.n_joint].reshape(-1, 10)
    bodies = tuple(int(i) for i in np.flatnonzero(links[:, 9] > 0.0))
    if not bodies:
        raise ConfigError(
            f"arm {arm.name!r}: no link has a mass, expected those of the table: calibrate with --mass, --height "
            "and --sex"
        )
    way = arm.way_to(bodies[0])
    slides = [i for i in way if not chain_of(arm).revolute[i]]
    others = [i for i in bodies if arm.way_to(i)[:N_FREE] != way]
    if len(way) != N_FREE or len(slides) != N_FREE // 2 or others:
        raise ConfigError(
            f"arm {arm.name!r} has no floating base, expected three joints that slide and three that turn before "
            f"the first link with a mass, and all others on it, as human-body has"
        )
    impossible = [str(i + 1) for i in bodies if not is_possible(links[i])]
    if impossible:
        raise ConfigError(
            f"arm {arm.name!r}: link {', '.join(impossible)} has a mass and inertia that no body can have, "
            f"expected a positive definite pseudo-inertia"
        )
    return FloatingBase(way, bodies, links[list(bodies)])


def base_regressor(motions: Sequence[LinkMotion]) -> Floats:
    """Return the six equations' columns of bodies, (n_sample, 6, 10 n_body).

    Parameters
    ----------
    motions : sequence of LinkMotion
        Of the bodies, the base link first: moments are about its origin.
    """
    about = motions[0].o
    Y = np.empty((len(about), 6, 10 * len(motions)))
    for k, motion in enumerate(motions):
        w, dw, dv = (
            np.einsum("nji,nj->ni", motion.R, x) for x in (motion.omega, motion.omega_dot, motion.acceleration)
        )
        spin = _cross_matrix(w)
        force, moment = np.zeros((len(w), 3, 10)), np.zeros((len(w), 3, 10))
        force[:, :, 6:9] = _cross_matrix(dw) + spin @ spin
        force[:, :, 9] = dv
        moment[:, :, :6] = _tensor_times(dw) + spin @ _tensor_times(w)
        moment[:, :, 6:9] = -_cross_matrix(dv)
        force, moment = motion.R @ force, motion.R @ moment
        Y[:, :3, 10 * k : 10 * k + 10] = force
        Y[:, 3:, 10 * k : 10 * k + 10] = moment + _cross_matrix(motion.o - about) @ force
    return Y


def along_joints(wrench: Floats, free: Sequence[LinkMotion], slides: Sequence[bool]) -> Floats:
    """Return the generalised forces of wrenches on a floating base's joints, (n_sample, 6).

    Parameters
    ----------
    wrench : (n_sample, 6)
        Force and moment about the last joint's origin, in the world.
    free : sequence of LinkMotion
        Of the six joints.
    slides : sequence of bool
    """
    about = free[-1].o
    rows = []
    for motion, sliding in zip(free, slides, strict=True):
        moment = wrench[:, 3:] + np.cross(about - motion.o, wrench[:, :3])
        rows.append(np.einsum("ni,ni->n", motion.R[:, :, 2], wrench[:, :3] if sliding else moment))
    return np.column_stack(rows)


def _cross_matrix(v: Floats) -> Floats:
    out = np.zeros((*v.shape, 3))
    out[:, 0, 1], out[:, 0, 2], out[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    out[:, 1, 0], out[:, 2, 0], out[:, 2, 1] = v[:, 2], -v[:, 1], v[:, 0]
    return out


def _tensor_times(v: Floats) -> Floats:
    """Return the columns by which ``I v`` is linear in ``xx yy zz xy xz yz``, (n, 3, 6)."""
    out = np.zeros((len(v), 3, 6))
    x, y, z = v.T
    out[:, 0, 0] = out[:, 1, 3] = out[:, 2, 4] = x
    out[:, 1, 1] = out[:, 0, 3] = out[:, 2, 5] = y
    out[:, 2, 2] = out[:, 0, 4] = out[:, 1, 5] = z
    return out
