"""Which of the pushes that a model misses are causes, all together as any cause is, and what their numbers are."""

from dataclasses import replace

import numpy as np

from fitter.diagnosis.disturbance_pulses import DisturbancePulses
from fitter.diagnosis.missed_pulses import fitted_with_pulses, missed_pulses, residual_torques, without_pulses
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.stepwise import Found, Stepwise
from fitter.diagnosis.torque.likeliest_pulses import at_likeliest, still_likely
from fitter.diagnosis.torque_likelihood import TorqueLikelihood


def with_pulses(likelihood: TorqueLikelihood, search: Stepwise, found: Found) -> Found:
    """Return what a search has found with the pushes that its model misses, as far as these are causes.

    Together they are accepted as any cause is, or the least evident of them goes. Each is judged by the residual
    over time, eq. (m.1), before that and beside all accepted causes. By blocks of a whole run a single one is not
    judged: it is in one or two of them, of which nothing says how they scatter.
    """
    final = found.final
    missed = missed_pulses(
        likelihood.regression,
        final.candidate,
        lambda: [(one.candidate, cost) for one, cost in search.possible(final)],
    )
    tried = sorted(missed, key=lambda one: one.evidence)
    while tried:
        fit = likelihood.fit_of(fitted_with_pulses(likelihood.regression, final.candidate, tried))
        accepted = search.extended(found, fit)
        if accepted is None:
            tried = tried[1:]
            continue
        residual = residual_torques(likelihood.regression, without_pulses(accepted.final.candidate))
        likely = still_likely(residual, tried)
        kept = [one for one in tried if any(map(one.overlaps, likely))]
        if len(kept) == len(tried):
            return accepted
        tried = kept
    # The weights are those of what was not accepted.
    return replace(found, final=likelihood.reweighted(final)) if missed else found


def with_likeliest_pulses(regression: Regression, final: Candidate) -> Candidate:
    """Return a model with its pushes where the residual over time is likeliest, eq. (m.1), with these errors.

    The equations' weights hold for a whole run. A push takes a fraction of a second, in which what the model
    misses resembles itself: weighed by them, it takes that for its own.
    """
    model = final.model
    if not any(isinstance(one, DisturbancePulses) for one in model.hypotheses):
        return final
    n_base = len(final.x) - model.n_column
    factors = np.split(final.x[n_base:], np.cumsum([one.n_column for one in model.hypotheses])[:-1])
    now = [
        pulse
        for one, own in zip(model.hypotheses, factors, strict=True)
        if isinstance(one, DisturbancePulses)
        for pulse in one.pulses(own)
    ]
    likeliest = at_likeliest(residual_torques(regression, without_pulses(final)), now)
    moved, x = Model(), [final.x[:n_base]]
    for one, psi, own in zip(model.hypotheses, model.psi, factors, strict=True):
        if isinstance(one, DisturbancePulses):
            pulses = [pulse for pulse in likeliest if pulse.joint == one.joints[0]]
            pushes = DisturbancePulses(one.kind, one.joints[0], pulses)
            moved = moved.plus(pushes, pushes.starts([])[0])
            x.append(np.array([pulse.impulse for pulse in pulses]))
        else:
            moved = moved.plus(one, psi)
            x.append(own)
    numbers = np.concatenate(x)
    return Candidate(moved, numbers, regression.squares(moved, numbers))
