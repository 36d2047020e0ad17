"""Pushes sought in what a model misses, the model fitted robustly beside those that were found."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.ndimage import binary_dilation, binary_opening

from arm.effects.catalogue import catalogue
from fitter.data.derivatives import lowpass
from fitter.diagnosis.disturbance_pulses import DisturbancePulses
from fitter.diagnosis.holding_torque import friction_at_rest
from fitter.diagnosis.least_squares import ITERATIONS, ODDS_NATS
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.robust_fit import robustly_fitted
from fitter.diagnosis.torque.likeliest_pulses import still_likely
from fitter.diagnosis.torque.pulse import Pulse, are_same
from fitter.diagnosis.torque.pulse_evidence import residual_log_evidence
from fitter.diagnosis.torque.pulses import find_pulses
from fitter.diagnosis.torque.residual_torque import ResidualTorque


def missed_pulses(
    regression: Regression, final: Candidate, possible: Callable[[], Sequence[tuple[Candidate, float]]] = tuple
) -> list[Pulse]:
    """Return the pushes that are found in what a model misses.

    The residual of a cause that was just too weak to be accepted is no push: a push is also likelier than not
    beside each model that is not excluded, unless all pushes together are a hundred times likelier than that
    model.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        With all causes that always act.
    possible : callable, optional
        Returns models with one cause more that are not excluded, and what that cause costs [nats].
    """
    found = _found(regression, final, find_pulses)
    for other, cost in possible() if found else ():
        likely = _found(regression, other, partial(still_likely, pulses=found))
        kept = [one for one in found if any(map(one.overlaps, likely))]
        if len(kept) < len(found) and cost + _gain(regression, (final, found), (other, likely)) < ODDS_NATS:
            found = kept
        if not found:
            break
    return found


def _found(
    regression: Regression, final: Candidate, sought: Callable[[Sequence[ResidualTorque]], list[Pulse]]
) -> list[Pulse]:
    """Return the pushes that are sought in what a model misses.

    Pushes bend the parameters of the model that they are sought in. So it is fitted anew beside those that were
    found, robustly, for some may yet be missed; and they are sought anew until the same are found again. Those
    that make the residual likeliest are returned: a later round may have lost what an earlier one had found.
    """
    rounds = list[tuple[float, list[Pulse]]]()
    found = list[Pulse]()
    for _ in range(ITERATIONS):
        residual = _residuals_beside(regression, final, found)
        found = sought(residual)
        rounds.append((residual_log_evidence(residual, found), found))
        if not found or any(are_same(found, one) for _, one in rounds[:-1]):
            break
    return max(rounds, key=lambda one: one[0])[1]


def _gain(
    regression: Regression, one: tuple[Candidate, list[Pulse]], other: tuple[Candidate, list[Pulse]]
) -> float:
    """Return by how much the residual of a model with pushes is likelier than another's, where both are known."""
    residuals = [_residuals_beside(regression, *both) for both in (one, other)]
    known = [a.known & b.known for a, b in zip(*residuals, strict=True)]
    shared = [
        [replace(trial, known=where) for trial, where in zip(trials, known, strict=True)] for trials in residuals
    ]
    return residual_log_evidence(shared[0], one[1]) - residual_log_evidence(shared[1], other[1])


def _residuals_beside(regression: Regression, model: Candidate, pulses: Sequence[Pulse]) -> list[ResidualTorque]:
    """Return what a model misses that was fitted robustly beside some pushes, without these."""
    beside = robustly_fitted(regression, fitted_with_pulses(regression, model, pulses))
    return residual_torques(regression, without_pulses(beside, len(model.model.hypotheses)))


def without_pulses(candidate: Candidate, first: int = 0) -> Candidate:
    """Return a model without its pushes, its other numbers as they are; from its ``first`` hypothesis on."""
    model = candidate.model
    kept = [k < first or not isinstance(one, DisturbancePulses) for k, one in enumerate(model.hypotheses)]
    of_column = np.repeat(kept, [one.n_column for one in model.hypotheses]).astype(np.bool_)
    n_base = len(candidate.x) - model.n_column
    x = np.concatenate([candidate.x[:n_base], candidate.x[n_base:][of_column]])
    return replace(candidate, model=model.only(kept), x=x)


def fitted_with_pulses(regression: Regression, final: Candidate, found: Sequence[Pulse]) -> Candidate:
    """Return a model with some pulses, fitted together with them; the same if there is none."""
    model, kind = final.model, catalogue()["external_push"]
    for joint in sorted({one.joint for one in found}):
        pushes = DisturbancePulses(kind, joint, [one for one in found if one.joint == joint])
        model = model.plus(pushes, pushes.starts([])[0])
    return fitted(regression, model, refine=False) if found else final


def residual_torques(regression: Regression, final: Candidate) -> list[ResidualTorque]:
    """Return what a model misses in every trial, within the band of its equations: a push has its own sign.

    Of a joint that rests for longer than the filter's reach nothing is known. Where it only turns back, all but
    its friction is.
    """
    own = regression.sensors
    angle_noise = np.sqrt(np.diag(own.acceleration_noise))
    trials = []
    for motion in regression.motions:
        residual = regression.equations.residual_torque(final.model, final.x, motion)
        r, torque = (lowpass(column, motion.dt_s, own.band_hz, "even") for column in (-residual, motion.u))
        reach = round(0.5 / (own.band_hz * motion.dt_s))  # so far the filter looks: half a period of its corner
        near = np.ones((2 * reach + 1, 1), dtype=np.bool_)
        guessed = regression.hypothetical(final.model, motion).guessed[:, None]
        rests = binary_opening(motion.stuck, near)
        known, seen = (~binary_dilation(one, near, border_value=1) for one in (rests | guessed, guessed))
        stuck = lowpass(motion.stuck.astype(np.float64), motion.dt_s, own.band_hz, "even")
        turning = np.clip(stuck, 0.0, 1.0)
        friction = friction_at_rest(regression.equations, final.model, final.x, motion)
        noises = own.band_hz, own.torque_noise, angle_noise
        trials.append(ResidualTorque(motion.t, r, known, torque, *noises, friction, turning, seen & ~known))
    return trials
