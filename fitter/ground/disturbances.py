"""What is neither rigid nor calibrated: columns beside those of the bodies, each with a coefficient about zero.

*Skin.* Markers do not ride on bone: with the posture they carry their segment's pose away from it, and with the
pose the place where the segment's mass is thought to be. It is always the same in the same posture, so no number
of repetitions averages it out. A body's centre of mass may therefore move in its link as a linear function of the
posture: of the joints before it and of the direction of gravity.

*Plates.* Their place among the cameras is known to a few millimetres, and so is their zero to a few newtons.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats, Marker
from fitter.ground.floating_base import FloatingBase
from fitter.ground.link_motion import LinkMotion

#: A posture that moves by this much [rad, or of gravity's direction: its sine] shows all of what skin does: a
#: joint that hardly turns hardly moves skin. Squats and gait turn joints by 20 degrees rms and more.
_POSTURE_RAD = 0.35
#: How far skin takes a marker along each axis, at the least [m]: 6 mm in space, of the 3 to 9 mm that Leardini et
#: al. (2005) report. What `std_m` says is what a fit could not follow, and skin that moves with the posture it
#: follows.
_SKIN_M = 0.006 / 3.0**0.5
#: Functions that move less than this, of that and of the largest, are left out.
_LEAST_POSTURE = 0.1
#: Distance from axis to marker of a segment whose markers are unknown [m], and the share of the widest spread
#: below which markers tell nothing of a turn.
_USUAL_SPREAD_M, _SEEN = 0.1, 1e-2
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
    """Return those of every body: joints between it and its neighbours, then gravity's direction."""
    gravity = np.array(arm.gravity_m_s2) / np.linalg.norm(arm.gravity_m_s2)
    found = []
    for body in base.bodies:
        motion, joints = motions[body], _joints_about(arm, base, body)
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


def _joints_about(arm: Arm, base: FloatingBase, body: int) -> list[int]:
    """Return the joints that turn between a body and its neighbours, from 0; none of the base's."""
    found = []
    for other in base.bodies:
        before = [i for i in arm.way_to(other)[:-1] if i in base.bodies]
        if before and body in (other, before[-1]):
            found += [i for i in arm.way_to(other) if i > before[-1] and arm.joints[i].type == "revolute"]
    return found


@dataclass(frozen=True)
class Skin:
    """The few functions of the posture that the learning trials show, over all of them; how far skin goes.

    Attributes
    ----------
    mean, mix : tuple of (n_function,), tuple of (n_function, n_kept), one a body
        Kept are ``(value - mean) @ mix``.
    shift_m, turn_rad : (n_body,)
        Of a body's centre along each axis of its link, and of the body about each, for a unit of a function.
    """

    mean: tuple[Floats, ...]
    mix: tuple[Floats, ...]
    shift_m: Floats
    turn_rad: Floats

    def stds(self) -> Floats:
        """Return the prior standard deviation of every column's coefficient, (n_column,)."""
        parts = []
        for mix, shift, turn in zip(self.mix, self.shift_m, self.turn_rad, strict=True):
            n_function = mix.shape[1]  # they share what skin does
            parts.append(np.tile(np.repeat([shift, turn], 3), n_function) / max(n_function, 1) ** 0.5)
        return np.concatenate(parts)


def skin_of(arm: Arm, base: FloatingBase, trials: Sequence[Sequence[Posture]]) -> Skin:
    """Return the skin of a person by the arm's markers and the postures of the learning trials."""
    mean, mix = [], []
    for k in range(len(base.bodies)):
        value = np.concatenate([trial[k].value for trial in trials])
        mean.append(value.mean(axis=0))
        _, size, axes = np.linalg.svd((value - mean[-1]) / np.sqrt(len(value)), full_matrices=False)
        kept = size > max(_LEAST_POSTURE * _POSTURE_RAD, _LEAST_POSTURE * float(size[0]))
        mix.append(axes[kept].T / np.maximum(size[kept], _POSTURE_RAD))
    std = np.array([_pose_std(arm, body, link) for body, link in zip(base.bodies, base.links, strict=True)])
    return Skin(tuple(mean), tuple(mix), std[:, 0], std[:, 1])


def _pose_std(arm: Arm, body: int, link: Floats) -> tuple[float, float]:
    """Return how far skin takes a body's centre of mass [m] and turns the body [rad]: errors of a rigid fit."""
    on_it: list[Marker] = [m for m in arm.markers if m.joint == body + 1]
    std = float(np.sqrt(np.mean([max(m.std_m or 0.0, _SKIN_M) ** 2 for m in on_it]))) if on_it else _SKIN_M
    if len(on_it) < 3:
        return std, std / _USUAL_SPREAD_M
    places = np.array([m.position_m for m in on_it])
    lever = link[6:9] / link[9] - places.mean(axis=0)
    places = places - places.mean(axis=0)
    turn = np.linalg.pinv(np.sum(places**2) * np.eye(3) - places.T @ places, rcond=_SEEN)
    across = np.array([[0.0, -lever[2], lever[1]], [lever[2], 0.0, -lever[0]], [-lever[1], lever[0], 0.0]])
    centre = np.eye(3) / len(on_it) + across @ turn @ across.T
    return std * float(np.sqrt(np.trace(centre) / 3.0)), std * float(np.sqrt(np.trace(turn) / 3.0))


def skin_columns(
    base: FloatingBase, motions: Sequence[LinkMotion], posture: Sequence[Posture], skin: Skin
) -> Floats:
    """Return what each coefficient adds to the six equations, (n_sample, 6, n_column).

    A centre at ``s(t) = R u f(t)`` beyond the link's own adds ``m s''`` to the force, and to the moment its lever
    times that and ``s x m a`` of the link; a body that is turned by ``R u f(t)`` adds its inertia times the
    second derivative.
    """
    about, columns = motions[base.bodies[0]].o, []
    for k, body in enumerate(base.bodies):
        motion, mass = motions[body], base.links[k, 9]
        own = motion.R @ _central_inertia(base.links[k])
        f = (posture[k].value - skin.mean[k]) @ skin.mix[k]
        df, ddf = posture[k].rate @ skin.mix[k], posture[k].second @ skin.mix[k]
        w, dw = motion.omega, motion.omega_dot
        for function in range(f.shape[1]):
            shifts, turns = [], []
            for axis in range(3):
                u = motion.R[:, :, axis]
                swing = np.cross(w, u)
                s = u * f[:, function, None]
                second = (
                    u * ddf[:, function, None]
                    + 2.0 * swing * df[:, function, None]
                    + (np.cross(dw, u) + np.cross(w, swing)) * f[:, function, None]
                )
                force = mass * second
                moment = np.cross(motion.o - about, force) + mass * np.cross(s, motion.acceleration)
                shifts.append(np.hstack([force, moment]))
                in_link = np.einsum("nji,nj->ni", motion.R, second)
                turns.append(np.hstack([np.zeros_like(force), np.einsum("nij,nj->ni", own, in_link)]))
            columns += [*shifts, *turns]
    return np.stack(columns, axis=2) if columns else np.empty((len(about), 6, 0))


def _central_inertia(link: Floats) -> Floats:
    xx, yy, zz, xy, xz, yz, *first, mass = link
    c = np.array(first) / mass
    about_origin = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.asarray(about_origin - mass * (c @ c * np.eye(3) - np.outer(c, c)))


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
