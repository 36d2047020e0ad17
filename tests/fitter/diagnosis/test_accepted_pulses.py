"""Pushes are causes together, and each is evident over time: none is one because it was found beside another."""

import numpy as np
import pytest

from arm.model import Effect
from fitter.diagnosis import accepted_pulses
from fitter.diagnosis.accepted_pulses import with_likeliest_pulses, with_pulses
from fitter.diagnosis.least_squares import MOST_CAUSES
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.screening import screen
from fitter.diagnosis.stepwise import Stepwise
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.diagnosis.searched import swinging

#: In the second of four trials of three seconds each, which may be learnt from, and in the third, which may not.
LEARNT, HELD_OUT = 4.2, 7.4


def searched(*pushes):
    names = "start_s", "duration_s", "torque_N_m"
    effects = [Effect("external_push", dict(zip(names, push, strict=True)), joints=(1,)) for push in pushes]
    likelihood = TorqueLikelihood(swinging(*effects, trials=4), [], screen)
    search = Stepwise(likelihood, 1, MOST_CAUSES)
    return likelihood, search, search.run()


def claimed(start_s, torque_N_m, evidence):
    trial = int(start_s // 3.0)
    return Pulse(trial, 0, start_s, 0.4, torque_N_m, 0.01, 0.01, 0.02, 0.01, "rectangular", evidence, evidence)


@pytest.mark.parametrize("start_s", [LEARNT, HELD_OUT])
def test_a_push_in_any_trial_is_a_cause(start_s):
    found = with_pulses(*searched((start_s, 0.4, 1.5)))
    (step,) = found.steps
    assert [one.start_s for one in step.hypothesis.found] == pytest.approx([start_s], abs=0.06)


def test_where_nothing_pushes_there_is_no_cause():
    likelihood, search, found = searched()
    assert with_pulses(likelihood, search, found).steps == ()


@pytest.mark.parametrize("evidence", [5.0, 500.0])
def test_what_was_claimed_beside_a_push_goes_unless_it_has_evidence_of_its_own(monkeypatch, evidence):
    claims = [claimed(LEARNT, 1.5, 100.0), claimed(HELD_OUT, 0.01, evidence)]
    monkeypatch.setattr(accepted_pulses, "missed_pulses", lambda *_: claims)
    (step,) = with_pulses(*searched((LEARNT, 0.4, 1.5))).steps
    assert [one.start_s for one in step.hypothesis.found] == [LEARNT]


def test_the_numbers_of_a_push_are_those_of_the_residual_over_time():
    likelihood, search, found = searched((LEARNT, 0.4, 1.5))
    regression, model = likelihood.regression, with_pulses(likelihood, search, found).final.candidate.model
    before = fitted(regression, model)
    after = with_likeliest_pulses(regression, before)
    (push,) = after.model.hypotheses
    numbers = push.numbers(after.model.psi[0], after.x[-1:])
    errors = push.standard_errors(np.zeros(3), regression.motions)
    assert np.all(np.abs(numbers - [LEARNT, 0.4, 1.5]) < 4.0 * errors)
    assert np.all(after.squares <= 1.05 * before.squares)


def test_a_model_without_pushes_stays_as_it_is():
    regression = searched()[0].regression
    plain = fitted(regression, Model())
    assert with_likeliest_pulses(regression, plain) is plain
