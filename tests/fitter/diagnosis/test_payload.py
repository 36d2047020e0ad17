"""When a load was taken up, and in which trials it was there."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.derived_trial import derive
from fitter.data.resample import resample
from fitter.diagnosis import error_floor
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.model import Model
from fitter.diagnosis.payload import Payload, find_payloads
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of
from fitter.diagnosis.screening import screen
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.pendulum import pendulum, swings


def regression_of(effect: Effect) -> Regression:
    trials = [derive(resample(motion), 30.0, 40.0) for motion in swings((effect,), trials=6)]
    return error_floor.regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))


def found(effect: Effect) -> list[Payload]:
    loads = find_payloads(regression_of(effect), Model())
    return [load for load in loads if isinstance(load, Payload)]


@pytest.mark.parametrize("since_s", [4.4, 10.1])
def test_the_moment_is_found(since_s):
    moment = found(Effect("payload", {"mass_kg": 0.3, "since_s": since_s}))[-1].since_s
    assert moment == pytest.approx(since_s, abs=0.05)


def test_the_trials_are_found():
    (carried, *_) = found(Effect("payload", {"mass_kg": 0.3, "trials": [2, 5]}))
    assert carried.trials == frozenset({2, 5})


def test_trials_that_other_weights_hid_are_found_again():
    """A load that was first seen in one of its two trials is in both, once what it explains is no floor."""
    regression = regression_of(Effect("payload", {"mass_kg": 0.3, "trials": [2, 5]}))
    likelihood = TorqueLikelihood(regression, [], screen, events=find_payloads)
    likelihood.base()
    partly = Payload(catalogue()["payload"], frozenset({2}))
    first = fitted(likelihood.regression, Model().plus(partly, np.zeros(0)))
    found = likelihood.reweighted(likelihood.fit_of(first)).candidate.hypothesis
    assert isinstance(found, Payload) and found.trials == frozenset({2, 5})
    assert likelihood.floor.is_none


def test_a_load_that_was_always_there_is_the_arms():
    regression = regression_of(Effect("payload", {"mass_kg": 0.3}))
    x = regression.solve(Model(), regression.motions)
    n_effective = sum(regression.weighting.n_effective(motion) for motion in regression.motions)
    assert np.all(np.isfinite(x)) and regression.squares(Model(), x).sum() < 1.3 * n_effective


def test_the_moment_has_an_error_that_holds():
    """It is fitted with the mass, between two samples as well as at one."""
    regression = regression_of(Effect("payload", {"mass_kg": 0.3, "since_s": 4.4033}))
    likelihood = TorqueLikelihood(regression, [], screen, events=find_payloads)
    likelihood.base()
    load = find_payloads(likelihood.regression, Model())[-1]
    first = fitted(likelihood.regression, Model().plus(load, load.starts([])[0]))
    found = likelihood.reweighted(likelihood.fit_of(first)).candidate
    (numbers,) = estimates(likelihood.regression, found).effects
    assert numbers["since_s"].unit == "s"
    for name, value in (("since_s", 4.4033), ("mass_kg", 0.3)):
        assert 0.0 < abs(numbers[name].value - value) < 3.5 * numbers[name].std < 0.1


def test_while_the_filter_smears_its_beginning_nothing_is_known():
    regression = regression_of(Effect("payload", {"mass_kg": 0.3, "since_s": 4.4}))
    load = Payload(catalogue()["payload"], since_s=4.4)
    for motion in regression.motions:
        guessed = regression.hypothetical(Model().plus(load, np.ones(1)), motion).guessed
        assert np.array_equal(guessed, np.abs(motion.t - 4.4) < 1.0 / 60.0)
