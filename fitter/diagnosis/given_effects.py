"""What a diagnosis makes of the effects that the arm file has already: they are known, and no cause.

Gravity's tilt, the zeros and air drag are other numbers of the arm. What acts on the torque on its way to the
joint, and on the angle behind it, is a hypothesis that every model has; one of the same kind at the same joint
replaces it. What resists a joint is taken out of the torque. Friction that is a base parameter is learnt with the
others, as that of the file's joints is.
"""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind, number
from arm.effects.effect_table import changed
from arm.effects.joint_torque import COULOMB
from arm.effects.resisting_torque import resisting_torque
from arm.effects.trials import acts_in
from arm.model import Arm, Effect, Floats
from fitter.diagnosis.arm_hypotheses import FrictionDrift, drag_column
from fitter.diagnosis.hypotheses import made
from fitter.diagnosis.joint_hypotheses import JointHypothesis, depends_on
from fitter.diagnosis.model import ActionOrder, Hypothesis, Model, is_one
from fitter.diagnosis.motion import HypotheticalMotion, Motion
from fitter.diagnosis.torque.pulse_column import pulse_means
from fitter.diagnosis.trial_clocks import on_run, on_trials


class GivenTorque(Hypothesis):
    """A torque with which joints are known to resist."""

    turn = ActionOrder.GIVEN

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion whose drive need not overcome it any more."""
        return replace(hypothetical, u=hypothetical.u - hypothetical.factor * self.torque_of(hypothetical))

    @abstractmethod
    def torque_of(self, hypothetical: HypotheticalMotion) -> Floats:
        """Return the torque with which the joints resist, (n_sample, n_joint)."""

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return none: nothing of it is sought."""
        return np.zeros(0)


class GivenResistance(GivenTorque):
    """The catalogue's torque at one joint, with given numbers."""

    def __init__(self, kind: EffectKind, joint: int, values: dict[str, float]) -> None:
        super().__init__(kind, (joint,))
        self._made = JointHypothesis(kind, joint, values)
        self.depends_on_torque = self._made.depends_on_torque

    def torque_of(self, hypothetical: HypotheticalMotion) -> Floats:
        """Return the torque with which the joint resists, (n_sample, n_joint)."""
        torque = np.zeros_like(hypothetical.q)
        torque[:, self.joints[0]] = self._made.torque(hypothetical, np.zeros(0))[:, 0]
        return torque


class GivenMass(GivenTorque):
    """A load or a rotor: on the clock of its trial."""

    def __init__(self, kind: EffectKind, effect: Effect) -> None:
        super().__init__(kind, tuple(joint - 1 for joint in effect.joints))
        self._effect = effect

    def torque_of(self, hypothetical: HypotheticalMotion) -> Floats:
        """Return what moves it, (n_sample, n_joint)."""
        motion, alone = hypothetical.motion, replace(hypothetical.arm, effects=(self._effect,))
        moved = hypothetical.q, hypothetical.dq, hypothetical.ddq
        return resisting_torque(alone, *moved, hypothetical.u, motion.t - motion.ahead_s, motion.identity)


class GivenDrag(GivenTorque):
    """The air drag of the arm's links."""

    def __init__(self, kind: EffectKind, arm: Arm) -> None:
        super().__init__(kind, ())
        self._drag = [joint.link.air_drag_N_m_s2 or 0.0 for joint in arm.joints]

    def torque_of(self, hypothetical: HypotheticalMotion) -> Floats:
        """Return the torque of the air, (n_sample, n_joint)."""
        return drag_column(hypothetical, self._drag)


class GivenEvent(GivenTorque):
    """A push: on the clock of its trial."""

    def __init__(self, kind: EffectKind, effect: Effect) -> None:
        super().__init__(kind, tuple(joint - 1 for joint in effect.joints))
        self._values = effect.parameters

    def torque_of(self, hypothetical: HypotheticalMotion) -> Floats:
        """Return what the push spares the drive, with its sign, (n_sample, n_joint)."""
        motion, values = hypothetical.motion, self._values
        torque, t = np.zeros_like(hypothetical.q), motion.t - motion.ahead_s
        if not acts_in(values, motion.identity):
            return torque
        start_s, duration_s, size = (number(values, one.name) for one in self.kind.numbers)
        pushed = size * pulse_means(t, motion.dt_s, start_s, duration_s, "rectangular")
        torque[:, self.joints] = -pushed[:, None]
        return torque


def given_model(arm: Arm) -> Model:
    """Return what of an arm's effects acts in every model, as hypotheses of given numbers.

    Parameters
    ----------
    arm : Arm
        As its file has it.
    """
    known = [(one, psi) for effect in arm.effects if not _is_nothing(effect) for one, psi in _given(effect)]
    acting = changed(arm)
    if any(joint.link.air_drag_N_m_s2 for joint in acting.joints):
        known.append((GivenDrag(catalogue()["air_drag"], acting), np.zeros(0)))
    return Model(tuple(one for one, _ in known), tuple(psi for _, psi in known))


def _is_nothing(effect: Effect) -> bool:
    """Say whether an effect's numbers are such that it does nothing."""
    neutral = [p for p in catalogue()[effect.name].numbers if p.neutral is not None]
    return bool(neutral) and all(number(effect.parameters, p.name) == p.neutral for p in neutral)


def _given(effect: Effect) -> list[tuple[Hypothesis, Floats]]:
    kind, joints = catalogue()[effect.name], [joint - 1 for joint in effect.joints]
    if kind.base or kind.change is not None or kind.place in ("sensor", "marker"):
        return []
    if kind.event:
        return [(GivenEvent(kind, effect), np.zeros(0))]
    if kind.torque is None and not is_one(kind):
        return [(GivenMass(kind, effect), np.zeros(0))]
    values = {parameter.name: number(effect.parameters, parameter.name) for parameter in kind.numbers}
    numbers = np.array(list(values.values()))
    if is_one(kind):
        return [(one := made(kind, (joint,)), one.psi_of(numbers)) for joint in joints]
    if depends_on(kind, COULOMB):
        return [(FrictionDrift(kind, (joint,)), numbers) for joint in joints]
    return [(GivenResistance(kind, joint, values), np.zeros(0)) for joint in joints]


def acting_arm(arm: Arm, motions: Sequence[Motion]) -> Arm:
    """Return an arm as a run's simulations have it: its effects on the run's clock, what they change changed.

    Parameters
    ----------
    arm : Arm
        As its file has it.
    motions : sequence of Motion
        All trials that it is to be simulated in.
    """
    acting: list[Effect] = []
    for effect in arm.effects:
        kind = catalogue()[effect.name]
        if kind.base or kind.change is not None or kind.place in ("sensor", "marker"):
            continue
        if is_one(kind):  # those of some joints may be replaced
            acting += [replace(effect, joints=(joint,)) for joint in effect.joints]
        else:
            acting.append(effect)
    return replace(changed(arm), effects=tuple(on_run(acting, motions)))


def as_in_file(arm: Arm, acting: Arm, learnt: Arm, motions: Sequence[Motion]) -> Arm:
    """Return a learnt arm as its file is to have it: the effects that it had, and those that were found.

    Parameters
    ----------
    arm : Arm
        As its file had it.
    acting : Arm
        The same as `acting_arm` has it, with which it was learnt.
    learnt : Arm
        What was learnt, on the run's clock.
    motions : sequence of Motion
        All trials of the run.
    """
    was = {id(effect) for effect in acting.effects}
    found = on_trials([effect for effect in learnt.effects if id(effect) not in was], motions)
    joints = [
        replace(
            one,
            link=replace(now.link, air_drag_N_m_s2=one.link.air_drag_N_m_s2),
            friction=replace(now.friction, static_N_m=one.friction.static_N_m),
        )
        for one, now in zip(arm.joints, learnt.joints, strict=True)
    ]
    kept = [effect for effect in _beside(arm.effects, found) if not catalogue()[effect.name].base]
    return replace(arm, joints=tuple(joints), base_parameters=learnt.base_parameters, effects=(*kept, *found))


def _beside(effects: Sequence[Effect], found: Sequence[Effect]) -> list[Effect]:
    """Return effects at those joints at which none was found that replaces them."""
    kept = []
    for effect in effects:
        gone = {
            joint
            for one in found
            if one.name == effect.name and (is_one(kind := catalogue()[one.name]) or kind.absolute)
            for joint in one.joints
        }
        left = tuple(joint for joint in effect.joints if joint not in gone)
        if left or not effect.joints:
            kept.append(replace(effect, joints=left))
    return kept
