"""Where the search begins, and when it is over."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.reading_diagnosis.sensor_frames import trials_of
from fitter.reading_diagnosis.sensor_search import Search, first_motions
from fitter.reading_diagnosis.trial_equations import Trials
from tests.fitter.reading_diagnosis.conftest import RATE_HZ, motion


@pytest.fixture(scope="module")
def search(measured_run):
    run = measured_run
    return Search(Trials(run.arm, trials_of(run.arm, [*run.learn, *run.evaluate]), len(run.learn)))


def test_the_motion_to_begin_with_is_near_the_true_one(search):
    q, _, _ = motion("dd-arm-vertical", 31)
    first = search.trials.trials[0]
    at = np.rint(first.t * RATE_HZ).astype(int)
    begun = first_motions(search.trials.arm, search.trials.trials)[0][1:-1]
    assert np.abs(begun - q[at]).max() < 0.05


def test_the_fitted_motion_is_nearer_than_a_milliradian(search):
    q, _, _ = motion("dd-arm-vertical", 31)
    first, c = search.trials.trials[0], search.base.motions[0]
    path = (c[:-2] + 4.0 * c[1:-1] + c[2:]) / 6.0
    np.testing.assert_allclose(path, q[np.rint(first.t * RATE_HZ).astype(int)], atol=4e-3)


def test_noise_is_as_large_as_it_was_measured_and_nothing_is_doubtful(search):
    assert search.noise == pytest.approx(1.0, abs=0.15)
    assert not search.doubtful(search.base)


def test_a_bias_beyond_what_one_sensor_in_a_thousand_has_is_doubtful(search):
    bias = search.base.hypothesis.bias.copy()
    bias[1] = 0.1
    assert search.doubtful(replace(search.base, hypothesis=replace(search.base.hypothesis, bias=bias)))


def test_a_score_is_what_trials_leave_and_what_it_takes(search):
    base, n = search.base, search.trials.n_learn
    expected = base.squares[n:].sum() / search.noise + base.usual + base.surprise
    assert search.score(search.base) == pytest.approx(expected)
