"""A pendulum's run, searched for a few effects only."""

from collections.abc import Sequence

from arm.model import Effect
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis import error_floor
from fitter.diagnosis.equal_causes import with_equals
from fitter.diagnosis.model import Hypothesis, Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of
from fitter.diagnosis.screening import screen
from fitter.diagnosis.search import Search, cause_of, supports
from fitter.diagnosis.stepwise import Found, Stepwise
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.pendulum import pendulum, swings

#: Causes at the most.
_MOST = 4


def regression_of(motions: Sequence[Measured], learning: int) -> Regression:
    """Return a pendulum's equations; the first few of its motions, may be learnt from."""
    trials = to_trials(motions, cutoff_hz=25.0)
    return error_floor.regression_of(pendulum(), run_of(pendulum(), trials[:learning], trials[learning:]))


def swinging(*effects: Effect, trials: int = 8, seed: int = 2) -> Regression:
    """Return the equations of a pendulum that has some effects; half of its trials may be learnt from."""
    return regression_of(swings(effects, trials=trials, seed=seed), trials // 2)


def found_in(regression: Regression, tried: Sequence[Hypothesis]) -> tuple[TorqueLikelihood, Found]:
    """Return what a search for some effects finds."""
    likelihood = TorqueLikelihood(regression, tried, screen)
    return likelihood, Stepwise(likelihood, max(len(tried), 1), _MOST).run()


def searched(regression: Regression, tried: Sequence[Hypothesis]) -> tuple[Regression, Search]:
    """Return the same as it is judged, with the equations under the weights of the final model."""
    likelihood, found = found_in(regression, tried)
    weighted, found = likelihood.regression, with_equals(likelihood, found)
    return weighted, Search(
        fitted(weighted, Model()),
        fitted(weighted, found.final.candidate.model),
        [cause_of(place, found) for place in range(len(found.steps))],
        found.base.candidate,
        [one.candidate for one in found.first],
        supports(found.first),
        likelihood.floor,
        likelihood.base_floor,
        in_vain=likelihood.in_vain,
    )
