"""Pushes found in what a model misses, and the model with them."""

from collections.abc import Mapping

import numpy as np

from arm.effects.catalogue import catalogue
from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.torque.missing_torque import ResidualTorque
from fitter.diagnosis.torque.pulses import find_pulses


def with_pushes(regression: Regression, final: Candidate) -> Candidate:
    """Return a model with the pushes that are found in what it misses; the same if there is none.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        With all causes that always act.
    """
    found: dict[int, list[tuple[float, float]]] = {}
    for pulse in find_pulses(missed(regression, final)):
        found.setdefault(pulse.joint, []).append((pulse.start_s, pulse.duration_s))
    return pushed(regression, final, found) if found else final


def pushed(regression: Regression, final: Candidate, found: Mapping[int, list[tuple[float, float]]]) -> Candidate:
    """Return a model with pushes at given times, which are refined: joint, from 0, to (start, duration) [s]."""
    model, kind = final.model, catalogue()["external_push"]
    for joint, times in found.items():
        pushes = Pushes(kind, joint, np.array(times), free=True)
        model = model.plus(pushes, pushes.starts([])[0])
    return fitted(regression, model, held=len(final.model.hypotheses))


def missed(regression: Regression, final: Candidate) -> list[ResidualTorque]:
    """Return what a model misses in every trial: a push has its own sign."""
    own = regression.sensors
    angle_noise = np.sqrt(np.diag(own.acceleration_noise))
    return [
        ResidualTorque(
            motion.t,
            -regression.equations.left(final.model, final.x, motion),
            ~motion.stuck,
            motion.u,
            own.band_hz,
            own.torque_noise,
            angle_noise,
        )
        for motion in regression.motions
    ]
