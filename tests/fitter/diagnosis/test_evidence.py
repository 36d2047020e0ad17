"""Worth counts numbers, places and families; what resembles its neighbours counts less; equals scatter."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.evidence import blocks_of, dispersion, is_better, log_evidence, penalised_log_likelihood
from tests.fitter.diagnosis.blocks import BLOCKS, CELLS, ROWS, fit_of

TRIALS = 8
N = TRIALS * BLOCKS * ROWS
SEEDS = st.integers(0, 10_000)


def noise(seed, n=N):
    return np.random.default_rng(seed).normal(size=n)


def explained(seed, size=1.0, numbers=1, learnt=None):
    """Return fits with and without a column, whose factor is found by least squares."""
    column, left = noise(seed + 1), noise(seed)
    left = left - column * (column @ left) / (column @ column)
    return fit_of(left, numbers, learnt), fit_of(left + size * column, 0, learnt)


@given(SEEDS, st.floats(0.0, 20.0), st.integers(0, 4))
def test_worth_falls_with_prior_odds_against_it_and_numbers(seed, against, more):
    one, base = explained(seed)
    lean = log_evidence(one, base, 0.0)
    assert log_evidence(one, base, against) == pytest.approx(lean - against)
    larger = replace(one, candidate=fit_of(noise(seed), 1 + more).candidate)
    penalty = 0.5 * more * np.log(TRIALS * BLOCKS)
    assert log_evidence(larger, base, 0.0) == pytest.approx(lean - penalty)
    assert penalised_log_likelihood(larger) == pytest.approx(penalised_log_likelihood(one) - penalty)


def test_worth_is_the_gain_by_its_dispersion_less_schwarz():
    one, base = explained(3, 0.5)
    found = one.gain(base) / dispersion(one, base) - 0.5 * np.log(TRIALS * BLOCKS) - 2.0
    assert log_evidence(one, base, 2.0) == pytest.approx(found)


def test_scores_of_independent_blocks_have_their_information():
    found = [dispersion(*explained(k, 0.3)) for k in range(0, 60, 2)]
    assert min(found) >= 1.0
    # The larger one of two variances, over blocks and over few trials, is a little more than one.
    assert np.median(found) < 1.6


@pytest.mark.parametrize("length", [5, 20, 100])
def test_what_is_left_for_longer_counts_less(length):
    """Column and residual that keep their values for several rows tell as many times less."""
    column, left = (np.repeat(noise(k, N // length), length) for k in (1, 2))
    left = left - column * (column @ left) / (column @ column)
    found = dispersion(fit_of(left, 1), fit_of(left + 0.3 * column))
    assert 0.4 * length < found < 2.5 * length


def test_whole_trials_that_pull_their_own_way_count_once_each():
    trial = np.arange(N) // (ROWS * BLOCKS)
    score_terms = np.where(trial % 2, 1.0, -1.0)
    column = noise(1)
    left = noise(2) + 0.5 * score_terms * column
    left = left - column * (column @ left) / (column @ column)
    apart = dispersion(fit_of(left, 1), fit_of(left + 0.3 * column))
    assert apart > 5.0 * dispersion(*explained(1, 0.3))


def test_where_nothing_was_added_nothing_is_dispersed():
    one, _ = explained(0)
    assert dispersion(one, one) == 1.0
    assert one.gain(one) == 0.0


@given(SEEDS, SEEDS, st.integers(0, 3), st.integers(0, 3), st.floats(0.5, 1.5))
@settings(max_examples=60)
def test_of_two_models_at_most_one_is_better(seed, other_seed, numbers, others, scale):
    one, other = fit_of(noise(seed), numbers), fit_of(scale * noise(other_seed), others)
    assert one.gain(other) == pytest.approx(-other.gain(one))
    assert not (is_better(one, other) and is_better(other, one))
    assert not is_better(one, one)


def test_a_difference_is_one_beyond_its_scatter_and_its_numbers():
    base = fit_of(noise(0))
    better = fit_of(0.8 * noise(0), 1)
    assert is_better(better, base) and not is_better(base, better)
    assert not is_better(fit_of(noise(1), 1), base)
    assert not is_better(replace(better, candidate=fit_of(noise(0), 100).candidate), base)


def test_it_has_to_help_where_nothing_was_learnt():
    left = noise(4)
    half = np.where(np.arange(N) < N // 2, 0.5, 1.2) * left
    one, base = fit_of(half, 1, TRIALS // 2), fit_of(left, 0, TRIALS // 2)
    assert one.gain(base) > 0.0
    assert not one.helps(base) and base.helps(one)
    assert fit_of(half).helps(fit_of(left))  # where no trial is held out, none is asked


def test_trials_in_which_nothing_of_it_acts_say_nothing_of_it():
    """They change by what it no longer bends, one way as often as the other."""
    left = noise(4)
    worse = fit_of(np.where(np.arange(N) >= N // 2, left + noise(9), 0.5 * left), 1, TRIALS // 2)
    base = fit_of(left, 0, TRIALS // 2)
    assert worse.held_out(base) < 0.0 and not worse.helps(base)
    assert replace(worse, acts=np.arange(TRIALS)[None] < TRIALS // 2).helps(base)


def test_the_density_of_a_motion_counts_with_what_is_left_of_it():
    one, base = explained(5, 0.0)
    heavier = replace(one, density=np.full(len(one.trial), 0.25))
    assert heavier.gain(base) == pytest.approx(one.gain(base) + 0.25 * len(one.trial))


@given(SEEDS, st.floats(0.1, 10.0))
def test_the_unit_of_what_is_left_does_not_matter(seed, unit):
    one, base = explained(seed)
    scaled = [replace(fit, residual=unit * fit.residual) for fit in (one, base)]
    assert scaled[0].gain(scaled[1]) == pytest.approx(one.gain(base))
    assert dispersion(*scaled) == pytest.approx(dispersion(one, base))


def test_what_is_alike_at_one_place_counts_once():
    """A misfit by the place in the motion, the same in all trials, scatters over places only."""
    place = np.arange(N) % CELLS
    shape, misfit = np.random.default_rng(3).normal(size=(2, CELLS))
    column = shape[place] + 0.1 * noise(4)
    left = misfit[place] + 0.1 * noise(5)
    left = left - column * (column @ left) / (column @ column)
    one, base = fit_of(left, 1), fit_of(left + 0.3 * column)
    anywhere = replace(one, cell=np.arange(N)[:, None])
    assert dispersion(anywhere, base) < 3.0
    assert 0.4 * N / CELLS < dispersion(one, base) < 2.5 * N / CELLS


def test_one_trial_of_another_kind_does_not_hide_what_the_others_show():
    one, base = explained(4, 0.5, learnt=TRIALS - 1)
    foreign = np.arange(N) // (ROWS * BLOCKS) == TRIALS - 1
    odd = replace(one, residual=np.where(foreign[:, None], 3.0 * base.residual, one.residual))
    assert odd.gain(base) < one.gain(base)
    alone = replace(one, learnt=np.ones_like(one.learnt))
    lean = log_evidence(replace(odd, learnt=alone.learnt), base, 0.0)
    assert log_evidence(odd, base, 0.0) > lean


def test_what_learning_trials_leave_open_shows_in_all():
    """The same gain decides where most was learnt from, and does not where little was."""
    one, base = explained(6, 0.12, 0)
    gain = one.gain(base)
    assert 5.0 < gain < 30.0
    few = [replace(fit, learnt=fit.trial < 1) for fit in (one, base)]
    assert not is_better(*few)


@pytest.mark.parametrize(("n_row", "step_s", "n_block"), [(250, 0.01, 2), (30, 0.01, 1), (400, 0.01, 4)])
def test_rows_are_split_into_blocks_of_equal_length_of_a_second_or_more(n_row, step_s, n_block):
    block = blocks_of(n_row, step_s)
    assert len(block) == n_row and np.all(np.diff(block) >= 0)
    sizes = np.bincount(block)
    assert len(sizes) == n_block and np.ptp(sizes) <= 1
