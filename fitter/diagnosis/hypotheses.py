"""All that may be wrong with the arm: every effect of the catalogue at every place where it can be."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind
from arm.effects.joint_torque import COULOMB, TAU
from arm.model import Arm, Floats
from fitter.diagnosis.arm_hypotheses import AirDrag, FrictionDrift, GravityTilt, JointZero, RotorInertia
from fitter.diagnosis.drive_hypotheses import Delay, Gain, Lag, Limit
from fitter.diagnosis.joint_hypotheses import JointHypothesis, depends_on, periods_tried
from fitter.diagnosis.model import Hypothesis
from fitter.diagnosis.transmission_hypotheses import Backlash, Elasticity

_Maker = Callable[[EffectKind, tuple[int, ...]], Hypothesis]
#: Places of an effect in an arm of n joints.
_Places = Callable[[int], list[tuple[int, ...]]]


def _everywhere(n_joint: int) -> list[tuple[int, ...]]:
    return [(j,) for j in range(n_joint)]


def _or_all(n_joint: int) -> list[tuple[int, ...]]:
    """Return every joint, and all of them alike."""
    return [*_everywhere(n_joint), *([tuple(range(n_joint))] if n_joint > 1 else [])]


#: How effects that are no torque against a joint's motion are sought, and where: those that are need no entry.
_MAKERS: dict[str, tuple[_Maker, _Places]] = {
    "gravity_tilt": (GravityTilt, lambda _n: [()]),
    "joint_zero": (JointZero, _everywhere),
    "rotor_inertia": (RotorInertia, _everywhere),
    "air_drag": (AirDrag, lambda n: _everywhere(n)[1:]),  # at the first joint it is what quadratic_drag is
    "gain_error": (Gain, _everywhere),
    "torque_saturation": (Limit, _everywhere),
    "actuator_delay": (Delay, _or_all),
    "actuator_lag": (Lag, _or_all),
    "backlash": (Backlash, _everywhere),
    "joint_elasticity": (Elasticity, _everywhere),
}


@dataclass(frozen=True)
class Reach:
    """What a joint reaches.

    Attributes
    ----------
    low, high : float [rad or m]
        Its lowest and its highest position.
    slides : bool
    lives : bool
        It turns, and is a living body's.
    """

    low: float
    high: float
    slides: bool = False
    lives: bool = False


#: Of a joint of which nothing is known but that it turns.
_ROUND = Reach(-np.pi, np.pi)


def hypotheses(
    n_joint: int, denied: tuple[str, ...] = (), driven: bool = True, reaches: Sequence[Reach] | None = None
) -> list[Hypothesis]:
    """Return every hypothesis about the joints that is no event.

    Parameters
    ----------
    n_joint : int
    denied : tuple of str
        Frictions that the base model leaves out: ``D``, ``fc``.
    driven : bool
        Whether a torque drives the arm: without one nothing can go wrong on its way.
    reaches : sequence of Reach, optional
        What each joint reaches; unless given, joints of a machine that go round.
    """
    found: list[Hypothesis] = []
    for name, kind in catalogue().items():
        if kind.base and kind.base not in denied:  # the base model has it
            continue
        if not driven and (kind.place in ("drive", "transmission") or depends_on(kind, TAU)):
            continue
        if name in _MAKERS:
            found += [made(kind, place) for place in _MAKERS[name][1](n_joint)]
        elif kind.place == "joint" and not kind.event:
            found += _at_joints(kind, reaches or [_ROUND] * n_joint)
    return found


def made(kind: EffectKind, joints: tuple[int, ...]) -> Hypothesis:
    """Return the hypothesis of an effect that is no torque against a joint's motion, at some joints from 0."""
    return _MAKERS[kind.name][0](kind, joints)


def reaches_of(arm: Arm, angles: Sequence[Floats]) -> list[Reach]:
    """Return what each joint of an arm reaches.

    Parameters
    ----------
    arm : Arm
    angles : sequence of (n_sample, n_joint) [rad or m]
        Of each motion.
    """
    low, high = np.min([q.min(axis=0) for q in angles], axis=0), np.max([q.max(axis=0) for q in angles], axis=0)
    ends = zip(map(float, low), map(float, high), (one.type == "prismatic" for one in arm.joints), strict=True)
    return [Reach(least, most, slides, arm.body is not None and not slides) for least, most, slides in ends]


def _at_joints(kind: EffectKind, reaches: Sequence[Reach]) -> list[Hypothesis]:
    if depends_on(kind, COULOMB):
        return [FrictionDrift(kind, (j,)) for j in range(len(reaches))]
    sides = (-1.0, 1.0) if any(p.name == "side" for p in kind.parameters) else ()
    if kind.is_living:
        return [
            JointHypothesis(kind, j, {"side": side, kind.stated_at: reach.high if side > 0.0 else reach.low})
            for j, reach in enumerate(reaches)
            if reach.lives
            for side in sides
        ]
    periods = [periods_tried(reach.high - reach.low, reach.slides) for reach in reaches]
    choices = [{"side": side} for side in sides] or [{}]
    return [JointHypothesis(kind, j, choice, one) for j, one in enumerate(periods) for choice in choices]
