"""Every question that is asked of a table before a fit, in their order."""

from collections.abc import Callable, Iterable

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.plausibility import (
    angle_unit,
    frozen,
    rate_sign,
    readings,
    repeats,
    saturated,
    time_unit,
    tip_unit,
    torque_unit,
    turns,
)
from fitter.data.plausibility.motion_sizes import continuous

#: Units first: every other question is asked in them. Turns are taken out before anything else is made of angles.
QUESTIONS: tuple[Callable[[Measured, Arm], Measured], ...] = (
    turns.look,
    time_unit.look,
    angle_unit.look,
    rate_sign.look,
    tip_unit.look,
    torque_unit.look,
    readings.look,
    repeats.look,
    frozen.look,
    saturated.look,
)


def questioned(motions: Iterable[Measured], arm: Arm) -> list[Measured]:
    """Return motions of files with what contradicts itself put right and noted.

    Parameters
    ----------
    motions : iterable of Measured
        As they were read, on their own time stamps.
    arm : Arm
        Whose motion they say they are.

    Raises
    ------
    Refusal
        If a column is not what it says it is: what was found, the likely cause, and how to state it.
    """
    return [_asked(motion, arm) for motion in motions]


def _asked(motion: Measured, arm: Arm) -> Measured:
    if "q" in motion.columns and not continuous(motion.columns["q"]):
        return motion  # poses that were measured one by one have no speeds, and nothing in them leaps or stalls
    for look in QUESTIONS:
        motion = look(motion, arm)
    return motion
