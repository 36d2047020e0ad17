"""An accepted step as a cause: its equals, those with more numbers, and all that it beat."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.diagnosis.search import cause_of, supports
from fitter.diagnosis.stepwise import Found, Step
from tests.fitter.diagnosis.blocks import BLOCKS, ROWS, fit_of
from tests.fitter.diagnosis.linear import Columns, LinearLikelihood

N = 8 * BLOCKS * ROWS


@given(st.lists(st.floats(0.5, 1.5), min_size=1, max_size=6))
def test_supports_are_shares_that_follow_the_likelihoods(scales):
    noise = np.random.default_rng(0).normal(size=N)
    found = np.array(supports([fit_of(scale * noise, 1) for scale in scales]))
    assert found.sum() == pytest.approx(1.0)
    assert np.all(found >= 0.0)
    order = np.argsort(scales, kind="stable")
    assert np.all(np.diff(found[order]) <= 1e-12)


def test_of_two_that_are_as_likely_each_has_half():
    noise = np.random.default_rng(0).normal(size=N)
    assert supports([fit_of(noise, 1), fit_of(-noise, 1)]) == pytest.approx([0.5, 0.5])
    assert supports([]) == []


@pytest.fixture
def cause():
    rng = np.random.default_rng(1)
    A = rng.normal(size=(800, 4))
    A[:, 1] = A[:, 0]
    tried = [Columns(0), Columns(1), Columns(0, 2), Columns(3)]
    likelihood = LinearLikelihood(A, 2.0 * A[:, 0] + rng.normal(size=800), tried)
    fits = [likelihood.fit_of(one) for one in tried]
    step = Step(tried[0], fits[0], likelihood.base(), 50.0, (fits[1], fits[2]), tuple(fits), (fits[1], fits[2]))
    return cause_of(0, Found(likelihood.base(), fits[0], (step,), ())), tried


def test_all_that_was_tried_is_told_apart(cause):
    cause, tried = cause
    assert cause.place == 0 and cause.itself.hypothesis is tried[0]
    assert [[one.hypothesis for one in some] for some in (cause.rivals, cause.larger, cause.beaten)] == [
        [tried[1]],
        [tried[2]],
        [tried[3]],
    ]
    assert cause.support == pytest.approx([0.5, 0.5])
    assert cause.before.model.hypotheses == ()


def test_what_it_takes_away_is_a_share_of_the_squares_of_some_trials(cause):
    cause, _ = cause
    n_trial = len(cause.itself.squares)
    # Of a variance of 5, with noise of 1.
    assert cause.takes_away([True] * n_trial) == pytest.approx(0.8, abs=0.05)
    first = [k == 0 for k in range(n_trial)]
    assert cause.takes_away(first) == pytest.approx(1.0 - cause.itself.squares[0] / cause.before.squares[0])
    assert cause.takes_away([False] * n_trial) == 0.0
