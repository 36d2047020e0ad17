"""Pushes as they are told: one cause each, on the clock of the file that it is in."""

from collections.abc import Sequence
from dataclasses import replace

from fitter.diagnosis.finding import NamedCause
from fitter.diagnosis.motion import Motion

_START = "start_s"
_NAMES = (_START, "duration_s", "torque_N_m")


def pushes_of(motions: Sequence[Motion], cause: NamedCause) -> list[NamedCause]:
    """Return a cause of several pushes as one cause each, with the trial that it is in.

    Parameters
    ----------
    motions : sequence of Motion
    cause : NamedCause
        Its starts are on the run's clock.
    """
    count, listed = len(cause.parameters) // len(_NAMES), []
    for k in range(1, count + 1):
        end = f"_{k}" if count > 1 else ""
        own = {name: cause.parameters[name + end] for name in _NAMES}
        motion = _trial_of(motions, own[_START].value)
        began = motion.trial.began_s - float(motion.t[0] - motion.trial.t[0])
        own[_START] = replace(own[_START], value=own[_START].value + began)
        listed.append(replace(cause, parameters=own, where={"trial": motion.trial.name}))
    return listed


def _trial_of(motions: Sequence[Motion], at_s: float) -> Motion:
    """Return the trial that an instant of the run's clock is in, or the one nearest to it."""
    return min(motions, key=lambda motion: max(float(motion.t[0]) - at_s, at_s - float(motion.t[-1])))
