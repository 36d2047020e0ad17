"""A push is found in what a model misses, with its own sign, and none where there is none."""

import numpy as np
import pytest

from arm.model import Effect
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.missed_pulses import fitted_with_pulses, missed_pulses, residual_torques
from fitter.diagnosis.screening import screen
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.diagnosis.searched import swinging

#: In the fourth and the seventh trial of three seconds each: one that may be learnt from, and one that may not.
PUSHES = ((10.2, 0.4, 1.5), (19.4, 0.5, -1.2))


def with_pulses(regression, base):
    return fitted_with_pulses(regression, base, missed_pulses(regression, base))


def pushed(numbers):
    names = "start_s", "duration_s", "torque_N_m"
    return Effect("external_push", dict(zip(names, numbers, strict=True)), joints=(1,))


def run(*pushes):
    likelihood = TorqueLikelihood(swinging(*map(pushed, pushes)), [], screen)
    base = likelihood.base()
    return likelihood.regression, base.candidate


@pytest.fixture(scope="module")
def hit():
    return run(*PUSHES)


def test_pushes_are_found_with_their_times_and_torques(hit):
    regression, base = hit
    found = with_pulses(regression, base)
    (numbers,) = estimates(regression, found).effects
    values = np.array([one.value for one in numbers.values()]).reshape(-1, 3)
    values = values[np.argsort(values[:, 0])]
    assert len(values) == len(PUSHES)
    np.testing.assert_allclose(values[:, :2], np.array(PUSHES)[:, :2], atol=0.06)
    np.testing.assert_allclose(values[:, 2], np.array(PUSHES)[:, 2], rtol=0.15)
    hit_trials = [any(one.t[0] < start < one.t[-1] for start, *_ in PUSHES) for one in regression.motions]
    assert np.all(found.squares[hit_trials] < 0.5 * base.squares[hit_trials])


def test_what_is_missed_has_the_sign_of_the_push(hit):
    regression, base = hit
    for start, lasts, torque in PUSHES:
        parts = [part for part in residual_torques(regression, base) if part.t[0] < start < part.t[-1]]
        (part,) = parts
        during = (part.t > start + 0.1) & (part.t < start + lasts - 0.1)
        # The base parameters take a part of what pushes that may be learnt from do.
        assert 0.5 < np.mean(part.r[during, 0]) / torque < 1.2


def test_where_nothing_pushes_the_model_stays_as_it_is():
    regression, base = run()
    assert with_pulses(regression, base) is base


def test_pushes_stand_behind_what_always_acts(hit):
    regression, base = hit
    start, lasts, torque = PUSHES[0]
    one = Pulse(3, 0, start, lasts, torque, 0.01, 0.01, 0.02, 0.01, "rectangular", 100.0, 90.0)
    found = fitted_with_pulses(regression, base, [one])
    (hypothesis,) = found.model.hypotheses
    assert hypothesis.key == ("external_push", (0,))
    assert found.squares.sum() < base.squares.sum()


@pytest.mark.parametrize("explained", [1, 2])
def test_what_a_possible_cause_explains_is_no_push(hit, explained):
    regression, base = hit
    places = zip((3, 6), PUSHES[:explained], strict=False)
    pulses = [Pulse(k, 0, *push, 0.01, 0.01, 0.02, 0.01, "rectangular", 100.0, 90.0) for k, push in places]
    cause = fitted_with_pulses(regression, base, pulses)
    found = missed_pulses(regression, base, lambda: [(cause, 0.0)])
    assert [one.start_s for one in found] == pytest.approx(
        [start_s for start_s, *_ in PUSHES[explained:]], abs=0.06
    )


def test_the_errors_of_a_push_hold_in_the_fit_with_all_other_numbers():
    """Its numbers are sought beside masses and friction, under weights that it no longer makes coarse."""
    likelihood = TorqueLikelihood(swinging(pushed((10.2, 0.25, 0.3))), [], screen)
    base = likelihood.base().candidate
    pushes = with_pulses(likelihood.regression, base)
    found = likelihood.reweighted(likelihood.fit_of(pushes))
    assert likelihood.is_exact(found, everywhere=True)
    (numbers,) = estimates(likelihood.regression, found.candidate).effects
    for name, value in (("start_s", 10.2), ("duration_s", 0.25), ("torque_N_m", 0.3)):
        assert abs(numbers[name].value - value) < 3.5 * numbers[name].std < value
