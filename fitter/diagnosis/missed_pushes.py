"""Pushes found in what a model misses, and the model with them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_dilation

from arm.effects.catalogue import catalogue
from fitter.data.derivatives import lowpass
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.robust import robustly_fitted
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.torque.missing_torque import ResidualTorque
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque.pulses import find_pulses


def with_pushes(regression: Regression, final: Candidate) -> Candidate:
    """Return a model with the pushes that are found in what it misses; the same if there is none.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        With all causes that always act.
    """
    candidate, known = robustly_fitted(regression, final), list[list[tuple[int, int]]]()
    while True:  # pushes bend the parameters of the model that they are sought in
        found = find_pulses(missed(regression, _without_pushes(final, candidate)))
        candidate = pushed(regression, final, found)
        places = [(one.trial, one.joint) for one in found]
        if not places or places in known:
            return candidate
        known.append(places)


def _without_pushes(final: Candidate, candidate: Candidate) -> Candidate:
    """Return a model that was fitted with pushes without them, its other numbers as they are."""
    n_hypothesis = len(final.model.hypotheses)
    return replace(
        candidate, model=candidate.model.only([k < n_hypothesis for k in range(len(candidate.model.hypotheses))])
    )


def pushed(regression: Regression, final: Candidate, found: Sequence[Pulse]) -> Candidate:
    """Return a model with some pushes, fitted beside them; the same if there is none."""
    model, kind = final.model, catalogue()["external_push"]
    for joint in sorted({one.joint for one in found}):
        model = model.plus(Pushes(kind, joint, [one for one in found if one.joint == joint]), np.zeros(0))
    return fitted(regression, model, refine=False) if found else final


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
        guessed = regression.view(final.model, motion).guessed[:, None]
        known = ~binary_dilation(motion.stuck | guessed, near, border_value=1)
        noises = own.band_hz, own.torque_noise, angle_noise
        trials.append(ResidualTorque(motion.t, r, known, torque, *noises))
    return trials
