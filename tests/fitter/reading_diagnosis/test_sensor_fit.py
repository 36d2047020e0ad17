"""What is fitted to readings together with the motion comes back."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.reading_diagnosis.sensor_fit import fit, judge
from fitter.reading_diagnosis.sensor_frames import trials_of
from fitter.reading_diagnosis.sensor_hypotheses import USUAL_BIAS_M_S2, Suspect, with_suspect, with_theta
from fitter.reading_diagnosis.sensor_search import first_motions
from fitter.reading_diagnosis.suspected_effects import EFFECTS
from fitter.reading_diagnosis.trial_equations import Trials

KINDS = {kind.name: kind for kind in reversed(EFFECTS)}

WRONG = (0.3, -0.2, 0.25)


@pytest.fixture(scope="module")
def trials(measure):
    run = measure(changed={1: {"bias_m_s2": WRONG}})
    return Trials(run.arm, trials_of(run.arm, [*run.learn, *run.evaluate]), len(run.learn))


@pytest.fixture(scope="module")
def biased(trials):
    hypothesis = with_suspect(trials.nothing(), Suspect(KINDS["sensor_bias"], 1), np.zeros(3))
    return judge(trials, fit(trials, hypothesis, first_motions(trials.arm, trials.trials)))


def test_a_bias_is_found_within_its_error(trials, biased):
    off = biased.hypothesis.values[0] - WRONG
    both = np.hypot(biased.std(0), 0.02)  # every sensor of the bench has one of 0.02 of its own
    assert np.all(np.abs(off) < 4.0 * both)


def test_what_is_left_under_the_right_hypothesis_is_noise(trials, biased):
    n, judging = trials.n_learn, trials.trials[trials.n_learn :]
    numbers = np.array([np.isfinite(one.values).sum() - 2 * len(one.values) for one in judging])
    assert np.all(np.abs(biased.squares[n:] / numbers - 1.0) < 6.0 * np.sqrt(2.0 / numbers))


def test_its_gradient_is_nothing_at_the_best(trials, biased):
    """The squared residual, with what is held before, changes by the second order only."""
    theta = np.concatenate([biased.hypothesis.bias.ravel(), *biased.hypothesis.values])
    mean, std = trials.before(biased.hypothesis)
    learn, known = range(trials.n_learn), biased.hypothesis
    done = trials.all_eliminated(learn, known, biased.motions, known.suspects)
    gram = np.sum([one for one, _ in done], axis=0)
    pull = gram[:-1, -1] + (mean - theta) / std**2
    assert pull @ biased.covariance @ pull < 0.1  # in units of the noise's variance


def test_numbers_in_a_row_are_the_hypothesis_numbers(trials, biased):
    theta = np.arange(15.0)
    moved = with_theta(biased.hypothesis, theta)
    np.testing.assert_array_equal(np.concatenate([moved.bias.ravel(), *moved.values]), theta)


def test_usual_biases_cost_one_each(trials, biased):
    usual = replace(biased.hypothesis, bias=np.full((4, 3), USUAL_BIAS_M_S2))
    assert replace(biased, hypothesis=usual).usual == pytest.approx(12.0)
