"""What an arm's effects and the air do to a trial's torque, taken out before the rest of the arm is learnt.

An arm that a diagnosis wrote has its causes in ``[[effect]]``. Their numbers are known; masses and friction are
learnt from what they leave. Afterwards they belong to the arm again, or it would be another one.
"""

from collections.abc import Sequence
from dataclasses import replace

from arm.effects.catalogue import catalogue
from arm.effects.effect_table import changed
from arm.effects.resisting_torque import resisting_torque
from arm.model import Arm, Floats
from arm.newton_euler import inverse_dynamics
from fitter.data.known_torque import without_torque
from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import Objective
from limbcal.errors import ConfigError
from limbcal.note import Note

#: Where an effect is part of the joints' torque, and where it lies between the measured torque and the joint.
_IN_TORQUE, _BEFORE_JOINT = ("joint", "arm"), ("drive", "transmission")


def without_effects(arm: Arm, trials: Sequence[Trial], objective: Objective = "torque") -> tuple[Arm, list[Trial]]:
    """Return an arm without its effects and its links' air drag, and trials whose torque is without them.

    What an effect changes of gravity and of the angles' zeros stays in the arm. Nothing is taken out where a
    motion is fitted that a law drives: its simulation has the effects.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
        With their measured torque, and their numbers in the run.
    objective : {"torque", "likelihood", "weighted", "robust", "motion"}
        What is fitted.

    Raises
    ------
    ConfigError
        If an effect lies between the measured torque and the joint, or a law drives the arm and not its motion is
        fitted.
    """
    if not _acts(arm) or (arm.control.law != "measured" and objective == "motion"):
        return arm, list(trials)
    names = sorted({effect.name for effect in arm.effects if catalogue()[effect.name].place in _BEFORE_JOINT})
    if names:
        raise ConfigError(
            f"arm {arm.name!r}: [[effect]] {', '.join(names)} lies between torque and joint, and cannot be taken "
            "out of a measured torque; expected an arm without it: fitter diagnose learns both"
        )
    if arm.control.law != "measured":
        raise ConfigError(
            f"arm {arm.name!r}: a law drives an arm with [[effect]] or air drag; expected measured torque, the "
            "objective motion, or an arm without them: fitter diagnose learns both"
        )
    acting = changed(arm)
    still = _without_air(acting)

    def bare(trial: Trial) -> Trial:
        def known(q: Floats, dq: Floats, ddq: Floats, tau: Floats, t: Floats) -> Floats:
            air = inverse_dynamics(acting, q, dq, ddq) - inverse_dynamics(still, q, dq, ddq)
            return air + resisting_torque(arm, q, dq, ddq, tau, t, trial.identity)

        return without_torque(trial, known)

    return replace(still, effects=()), [bare(trial) for trial in trials]


def taken_out_notes(arm: Arm, plain: Arm) -> list[Note]:
    """Say which effects were taken out of the torque; nothing if none was.

    Parameters
    ----------
    arm, plain : Arm
        As it was given, and as `without_effects` has it.
    """
    if plain is arm:
        return []
    names = sorted({one.name for one in arm.effects if catalogue()[one.name].place in _IN_TORQUE})
    said = ", ".join(names) or "the links' air drag"
    return [Note("effects", f"what {said} does is known from the arm file: it was taken out of the torque")]


def _without_air(arm: Arm) -> Arm:
    links = [replace(joint.link, air_drag_N_m_s2=None) for joint in arm.joints]
    return replace(
        arm, joints=tuple(replace(joint, link=link) for joint, link in zip(arm.joints, links, strict=True))
    )


def _acts(arm: Arm) -> bool:
    places = {catalogue()[effect.name].place for effect in arm.effects}
    return bool(places.intersection((*_IN_TORQUE, *_BEFORE_JOINT))) or any(
        joint.link.air_drag_N_m_s2 for joint in arm.joints
    )


def with_effects_of(arm: Arm, learnt: Arm) -> Arm:
    """Return a learnt arm with the effects, the gravity and the zeros of the arm that it was learnt of.

    Parameters
    ----------
    arm : Arm
        As it was given.
    learnt : Arm
        Without effects, as `without_effects` has it.
    """
    if not _acts(arm):
        return learnt
    joints = tuple(
        replace(
            was,
            link=replace(now.link, air_drag_N_m_s2=was.link.air_drag_N_m_s2),
            friction=now.friction,
        )
        for was, now in zip(arm.joints, learnt.joints, strict=True)
    )
    return replace(learnt, joints=joints, effects=arm.effects, gravity_m_s2=arm.gravity_m_s2)
