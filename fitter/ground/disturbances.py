"""What is neither rigid nor calibrated: columns beside those of the bodies, each with a coefficient about zero.

*Skin.* Markers do not ride on bone: with the posture they carry their segment's pose away from it, and with the pose
the place where the segment's mass is thought to be. It is always the same in the same posture, so no number of
repetitions averages it out. A body's centre of mass may therefore move in its link as a linear function of the posture:
of the joints before it and of the direction of gravity.

*Plates.* Their place among the cameras is known to a few millimetres, and so is their zero to a few newtons.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats, Marker
from fitter.ground.floating_base import FloatingBase
from fitter.ground.link_motion import LinkMotion

#: A posture that moves by this much [rad, or of gravity's direction: its sine] shows all of what skin does: a joint
#: that hardly turns hardly moves skin. Squats and gait turn joints by 20 degrees rms and more.
_POSTURE_RAD = 0.35
#: How far skin lets a marker wander where the arm file does not say [m] (Leardini et al. 2005).
_SKIN_M = 0.008
#: Of the plates' place among the cameras [m], and of their zero [N]: usual in laboratories (Collins et al. 2009).
PLATE_M, ZERO_N = 0.003, 2.0


@dataclass(frozen=True)
class Posture:
    """Functions of the posture that may move a body's centre in its link, and their derivatives.

    Attributes
    ----------
    value, rate, second : (n_sample, n_function)
    """

    value: Floats
    rate: Floats
    second: Floats


def postures(
    arm: Arm, base: FloatingBase, motions: Sequence[LinkMotion], q: Floats, dq: Floats, ddq: Floats
) -> list[Posture]:
    """Return those of every body: joints between it and the body before it, then gravity's direction."""
    gravity = np.array(arm.gravity_m_s2) / np.linalg.norm(arm.gravity_m_s2)
    found = []
    for body in base.bodies:
        motion, joints = motions[body], _own_joints(arm, base, body)
        down, w, dw = (
            np.einsum("nji,nj->ni", motion.R, x)
            for x in (np.tile(gravity, (len(q), 1)), motion.omega, motion.omega_dot)
        )
        rate = np.cross(down, w)
        second = np.cross(rate, w) + np.cross(down, dw)
        found.append(
            Posture(
                np.hstack([q[:, joints], down]),
                np.hstack([dq[:, joints], rate]),
                np.hstack([ddq[:, joints], second]),
            )
        )
    return found


def _own_joints(arm: Arm, base: FloatingBase, body: int) -> list[int]:
    way = arm.way_to(body)
    before = [i for i in way[:-1] if i in base.bodies]
    first = way.index(before[-1]) + 1 if before else len(way)
    return [i for i in way[first:] if arm.joints[i].type == "revolute"]


@dataclass(frozen=True)
class Skin:
    """Where postures are counted from and in what unit, over all learning trials; how far skin goes.

    Attributes
    ----------
    mean, size : tuple of (n_function,), one a body
    std_m : (n_body,)
        Of a body's centre, along each axis of its link, for a unit of a posture's function.
    """

    mean: tuple[Floats, ...]
    size: tuple[Floats, ...]
    std_m: Floats

    def stds(self) -> Floats:
        """Return the prior standard deviation of every column's coefficient, (n_column,)."""
        return np.concatenate(
            [np.full(3 * len(size), std) for size, std in zip(self.size, self.std_m.tolist(), strict=True)]
        )


def skin_of(arm: Arm, base: FloatingBase, trials: Sequence[Sequence[Posture]]) -> Skin:
    """Return the skin of a person by the arm's markers and the postures of the learning trials."""
    mean, size = [], []
    for k in range(len(base.bodies)):
        value = np.concatenate([trial[k].value for trial in trials])
        mean.append(value.mean(axis=0))
        size.append(np.maximum(value.std(axis=0), _POSTURE_RAD))
    std = np.array([_centre_std(arm, body, link) for body, link in zip(base.bodies, base.links, strict=True)])
    return Skin(tuple(mean), tuple(size), std)


def _centre_std(arm: Arm, body: int, link: Floats) -> float:
    """Return how far skin takes a body's centre of mass: a rigid fit carries markers' errors there."""
    on_it: list[Marker] = [m for m in arm.markers if m.joint == body + 1]
    std = float(np.sqrt(np.mean([(m.std_m or _SKIN_M) ** 2 for m in on_it]))) if on_it else _SKIN_M
    if len(on_it) < 3:
        return std
    places = np.array([m.position_m for m in on_it])
    lever = link[6:9] / link[9] - places.mean(axis=0)
    places = places - places.mean(axis=0)
    spread = np.sum(places**2) * np.eye(3) - places.T @ places
    across = np.array([[0.0, -lever[2], lever[1]], [lever[2], 0.0, -lever[0]], [-lever[1], lever[0], 0.0]])
    covariance = np.eye(3) / len(on_it) + across @ np.linalg.pinv(spread, rcond=1e-2) @ across.T
    return std * float(np.sqrt(np.trace(covariance) / 3.0))


def skin_columns(base: FloatingBase, motions: Sequence[LinkMotion], posture: Sequence[Posture], skin: Skin) -> Floats:
    """Return what a metre of each coefficient adds to the six equations, (n_sample, 6, n_column).

    A centre at ``s(t) = R u f(t)`` beyond the link's own adds ``m s''`` to the force, and to the moment its lever times
    that and ``s x m a`` of the link.
    """
    about, columns = motions[base.bodies[0]].o, []
    for k, body in enumerate(base.bodies):
        motion, mass = motions[body], base.links[k, 9]
        f = (posture[k].value - skin.mean[k]) / skin.size[k]
        df, ddf = posture[k].rate / skin.size[k], posture[k].second / skin.size[k]
        w, dw = motion.omega, motion.omega_dot
        for function in range(f.shape[1]):
            for axis in range(3):
                u = motion.R[:, :, axis]
                turn = np.cross(w, u)
                s = u * f[:, function, None]
                second = (
                    u * ddf[:, function, None]
                    + 2.0 * turn * df[:, function, None]
                    + (np.cross(dw, u) + np.cross(w, turn)) * f[:, function, None]
                )
                force = mass * second
                moment = np.cross(motion.o - about, force) + mass * np.cross(s, motion.acceleration)
                columns.append(np.hstack([force, moment]))
    return np.stack(columns, axis=2)


def plate_columns(wrench: Floats) -> Floats:
    """Return what a metre of the plates' shift and a newton of their zero add to the six equations, (n, 6, 6).

    Parameters
    ----------
    wrench : (n_sample, 6)
        Of the ground about the base link's origin.
    """
    columns = np.zeros((len(wrench), 6, 6))
    for axis in range(3):
        columns[:, 3:, axis] = np.cross(np.eye(3)[axis], wrench[:, :3])
        columns[:, axis, 3 + axis] = 1.0
    return columns


def plate_stds() -> Floats:
    """Return the prior standard deviations of the plates' coefficients, (6,)."""
    return np.array([PLATE_M] * 3 + [ZERO_N] * 3)
