"""Pushes found in what a model misses, and the model with them."""

from collections.abc import Mapping

import numpy as np

from arm.effects.catalogue import catalogue
from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.evidence import EQUAL_SIGMAS
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.torque.missing_torque import ResidualTorque
from fitter.diagnosis.torque.pulses import find_pulses

#: A push that stands beside a larger one is found once that one is known: so often they are sought.
_ROUNDS = 3


def with_pushes(regression: Regression, final: Candidate) -> Candidate:
    """Return a model with the pushes that are found in what it misses; the same if there is none.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        With all causes that always act.
    """
    candidate, known = final, dict[int, list[tuple[float, float]]]()
    for _ in range(_ROUNDS):
        pulses = find_pulses(missed(regression, candidate))
        found = {joint: list(times) for joint, times in known.items()}
        for pulse in pulses:
            found.setdefault(pulse.joint, []).append((pulse.start_s, pulse.duration_s))
        dropped = bool(pulses)
        while dropped and found:
            candidate = pushed(regression, final, found)
            found, dropped = _significant(regression, final, candidate)
        if len(_flat(found)) <= len(_flat(known)):
            break
        known = found
    return pushed(regression, final, known) if known else final


def _flat(found: Mapping[int, list[tuple[float, float]]]) -> list[tuple[float, float]]:
    return [one for times in found.values() for one in times]


def _significant(
    regression: Regression, final: Candidate, candidate: Candidate
) -> tuple[dict[int, list[tuple[float, float]]], bool]:
    """Return the pushes of a model whose torque differs significantly from zero, and whether others do not."""
    first, kept, dropped = len(final.model.hypotheses), dict[int, list[tuple[float, float]]](), False
    effects = estimates(regression, candidate).effects[first:]
    for hypothesis, numbers in zip(candidate.model.hypotheses[first:], effects, strict=True):
        listed = list(numbers.values())
        for start, duration, torque in zip(listed[::3], listed[1::3], listed[2::3], strict=True):
            if abs(torque.value) > EQUAL_SIGMAS * torque.std:
                kept.setdefault(hypothesis.joints[0], []).append((start.value, duration.value))
            else:
                dropped = True
    return kept, dropped


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
