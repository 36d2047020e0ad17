"""Pushes found in what a model misses, and the model with them."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_dilation

from arm.effects.catalogue import catalogue
from fitter.data.derivatives import lowpass
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.least_squares import EQUAL_SIGMAS
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.torque.missing_torque import ResidualTorque
from fitter.diagnosis.torque.pulses import Pulse, find_pulses

#: Pushes bend the parameters of the model that they are sought in: so often it is fitted with them and they anew.
_ROUNDS = 3


def with_pushes(regression: Regression, final: Candidate) -> Candidate:
    """Return a model with the pushes that are found in what it misses; the same if there is none.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        With all causes that always act.
    """
    candidate, known = final, list[Pulse]()
    for _ in range(_ROUNDS):
        found = find_pulses(missed(regression, _without_pushes(final, candidate)))
        if [(one.trial, one.joint) for one in found] == [(one.trial, one.joint) for one in known]:
            break
        known, times = found, dict[int, list[tuple[float, float]]]()
        for one in found:
            times.setdefault(one.joint, []).append((one.start_s, one.duration_s))
        candidate = _pushed_significantly(regression, final, times)
    return candidate


def _pushed_significantly(
    regression: Regression, final: Candidate, times: Mapping[int, list[tuple[float, float]]]
) -> Candidate:
    """Return a model with those pushes whose torque, like the size of any cause, differs from none."""
    while times:
        candidate, kept = pushed(regression, final, times), dict[int, list[tuple[float, float]]]()
        effects = estimates(regression, candidate).effects[len(final.model.hypotheses) :]
        for joint, numbers in zip(times, effects, strict=True):
            starts, durations, torques = (list(numbers.values())[k::3] for k in range(3))
            for start, duration, torque in zip(starts, durations, torques, strict=True):
                if abs(torque.value) > EQUAL_SIGMAS * torque.std:
                    kept.setdefault(joint, []).append((start.value, duration.value))
        if sum(map(len, kept.values())) == sum(map(len, times.values())):
            return candidate
        times = kept
    return final


def _without_pushes(final: Candidate, candidate: Candidate) -> Candidate:
    """Return a model that was fitted with pushes without them, its other numbers as they are."""
    model, n_hypothesis = candidate.model, len(final.model.hypotheses)
    kept = model.only([k < n_hypothesis for k in range(len(model.hypotheses))])
    return replace(candidate, model=kept, x=candidate.x[: len(candidate.x) - model.n_column + kept.n_column])


def pushed(regression: Regression, final: Candidate, found: Mapping[int, list[tuple[float, float]]]) -> Candidate:
    """Return a model with pushes at given times, which are refined: joint, from 0, to (start, duration) [s]."""
    model, kind = final.model, catalogue()["external_push"]
    for joint, times in found.items():
        pushes = Pushes(kind, joint, np.array(times), free=True)
        model = model.plus(pushes, pushes.starts([])[0])
    return fitted(regression, model, held=len(final.model.hypotheses))


def missed(regression: Regression, final: Candidate) -> list[ResidualTorque]:
    """Return what a model misses in every trial, within the band of its equations: a push has its own sign."""
    own = regression.sensors
    angle_noise = np.sqrt(np.diag(own.acceleration_noise))
    trials = []
    for motion in regression.motions:
        left = regression.equations.left(final.model, final.x, motion)
        r, torque = (lowpass(column, motion.dt_s, own.band_hz, "even") for column in (-left, motion.u))
        reach = round(0.5 / (own.band_hz * motion.dt_s))  # so far the filter looks: half a period of its corner
        near = np.ones((2 * reach + 1, 1), dtype=np.bool_)
        known = ~binary_dilation(motion.stuck, near, border_value=1)
        noises = own.band_hz, own.torque_noise, angle_noise
        trials.append(ResidualTorque(motion.t, r, known, torque, *noises))
    return trials
