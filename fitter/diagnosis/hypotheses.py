"""All that may be wrong with the arm: every effect of the catalogue at every place where it can be."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind
from arm.effects.joint_torque import COULOMB, TAU
from arm.model import Arm, Floats
from fitter.diagnosis.arm_hypotheses import AirDrag, FrictionDrift, GravityTilt, JointZero, RotorInertia
from fitter.diagnosis.drive_hypotheses import Delay, Gain, Lag, Limit
from fitter.diagnosis.joint_hypotheses import JointHypothesis, depends_on
from fitter.diagnosis.model import Hypothesis
from fitter.diagnosis.transmission_hypotheses import Backlash, Elasticity

_Maker = Callable[[EffectKind, tuple[int, ...]], Hypothesis]
#: Lowest and highest angle that a joint reaches [rad].
Ends = tuple[float, float]
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


def hypotheses(
    n_joint: int, denied: tuple[str, ...] = (), driven: bool = True, living: Mapping[int, Ends] | None = None
) -> list[Hypothesis]:
    """Return every hypothesis about the joints that is no event.

    Parameters
    ----------
    n_joint : int
    denied : tuple of str
        Frictions that the base model leaves out: ``D``, ``fc``.
    driven : bool
        Whether a torque drives the arm: without one nothing can go wrong on its way.
    living : mapping from joint to (lowest, highest) angle [rad], optional
        Turning joints of a living body, from 0, with the ends of the range that the motion reaches; none unless
        given.
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
            found += _at_joints(kind, n_joint, living or {})
    return found


def made(kind: EffectKind, joints: tuple[int, ...]) -> Hypothesis:
    """Return the hypothesis of an effect that is no torque against a joint's motion, at some joints from 0."""
    return _MAKERS[kind.name][0](kind, joints)


def living_ranges(arm: Arm, angles: Sequence[Floats]) -> dict[int, Ends]:
    """Return the range that each turning joint of a living body reaches, joints from 0; none of a machine's.

    Parameters
    ----------
    arm : Arm
    angles : sequence of (n_sample, n_joint) [rad or m]
        Of each motion.
    """
    if arm.body is None:
        return {}
    low, high = np.min([q.min(axis=0) for q in angles], axis=0), np.max([q.max(axis=0) for q in angles], axis=0)
    turning = [j for j, joint in enumerate(arm.joints) if joint.type == "revolute"]
    return {j: (float(low[j]), float(high[j])) for j in turning}


def _at_joints(kind: EffectKind, n_joint: int, living: Mapping[int, Ends]) -> list[Hypothesis]:
    if depends_on(kind, COULOMB):
        return [FrictionDrift(kind, (j,)) for j in range(n_joint)]
    sides = (-1.0, 1.0) if any(p.name == "side" for p in kind.parameters) else ()
    if kind.is_living:
        return [
            JointHypothesis(kind, j, {"side": side, kind.stated_at: ends[side > 0.0]})
            for j, ends in living.items()
            for side in sides
        ]
    choices = [{"side": side} for side in sides] or [{}]
    return [JointHypothesis(kind, j, choice) for j in range(n_joint) for choice in choices]
