"""Which of the pushes that a model misses are causes: each as any cause must be, and beside all others."""

from collections.abc import Sequence
from dataclasses import replace

from fitter.diagnosis.evidence import Fit
from fitter.diagnosis.missed_pulses import fitted_with_pulses, missed_pulses
from fitter.diagnosis.stepwise import Found, Stepwise
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque_likelihood import TorqueLikelihood


def with_pulses(likelihood: TorqueLikelihood, search: Stepwise, found: Found) -> Found:
    """Return what a search has found with the pushes that its model misses, as far as these are causes.

    The least evident of them go until the others are accepted as any cause is, and each has enough evidence beside
    the others.
    """
    final = found.final

    def fit_with(some: Sequence[Pulse]) -> Fit:
        return likelihood.fit_of(fitted_with_pulses(likelihood.regression, final.candidate, some))

    def without(some: Sequence[Pulse], one: Pulse) -> list[Pulse]:
        return [other for other in some if other is not one]

    missed = missed_pulses(
        likelihood.regression,
        final.candidate,
        lambda: [(one.candidate, cost) for one, cost in search.possible(final)],
    )
    tried = sorted(missed, key=lambda one: one.evidence)
    while tried:
        weak = tried[:1]
        if (accepted := search.extended(found, fit_with(tried))) is not None:
            others = [(one, without(tried, one)) for one in tried if len(tried) > 1]
            weak = [one for one, rest in others if not search.outweighs(accepted.final, fit_with(rest))]
            if not weak:
                return accepted
        tried = without(tried, weak[0])
    # The weights are those of what was not accepted.
    return replace(found, final=likelihood.reweighted(final)) if missed else found
