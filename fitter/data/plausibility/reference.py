"""A target whose time or angles are in other units than seconds and radians: there may be no motion with it."""

from dataclasses import replace

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.plausibility import angle_unit, time_unit


def look(motion: Measured, arm: Arm) -> Measured:
    """Return a target that is to be simulated, or refuse it where it is not in seconds and radians.

    Raises
    ------
    Refusal
        With the likely unit.
    """
    for role in ("q", "ref"):
        if role in motion.columns:
            stated = frozenset(name.replace("ref", "q") if role == "ref" else name for name in motion.stated)
            as_angle = replace(motion, columns={"q": motion.columns[role]}, stated=stated)
            time_unit.look(as_angle, arm)
            angle_unit.look(as_angle, arm)
    return motion
