"""The search by plain linear regression: it knows neither what a likelihood is made of nor what is tried."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.evidence import is_better, penalised_log_likelihood
from fitter.diagnosis.stepwise import Stepwise
from tests.fitter.diagnosis.linear import BLOCKS, ROWS, Columns, LinearLikelihood

N, MOST = 16 * BLOCKS * ROWS, 6
SEEDS = st.integers(0, 10_000)


def drawn(seed, k):
    """Return columns (n, k) and noise (n,)."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=(N, k)), rng.normal(size=N)


def search(columns, y, *tried, most=MOST, **given):
    tried = tried or tuple(Columns(k) for k in range(columns.shape[1]))
    likelihood = LinearLikelihood(columns, y, tried, **given)
    return Stepwise(likelihood, len(tried), most).run()


def columns_of(found):
    assert [step.hypothesis for step in found.steps] == list(found.final.candidate.model.hypotheses)
    return [step.hypothesis.joints for step in found.steps]


@given(SEEDS, st.sets(st.integers(0, 7), max_size=4), st.floats(0.5, 3.0))
@settings(max_examples=25, deadline=None)
def test_true_columns_are_found_the_largest_first_and_no_others(seed, true, least):
    A, noise = drawn(seed, 8)
    sizes = least * 1.5 ** np.arange(len(true))
    y = A[:, sorted(true)] @ sizes + noise
    found = search(A, y)
    assert columns_of(found) == [(k,) for k in sorted(true, reverse=True)]
    assert all(step.log_evidence > 0.0 for step in found.steps)
    np.testing.assert_allclose(found.final.candidate.x, sizes[::-1], atol=0.3)
    assert len(found.first) == 8
    assert sorted(found.first, key=penalised_log_likelihood, reverse=True) == list(found.first)


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_noise_has_no_cause(seed):
    A, noise = drawn(seed, 5)
    found = search(A, noise)
    assert found.steps == ()
    assert found.final is found.base


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_standard_models_have_is_worth_more_by_the_prior_odds(seed):
    A, noise = drawn(seed, 5)
    odd, usual = (
        search(A, A[:, 2] + noise, *(Columns(k, effect=effect) for k in range(5)))
        for effect in ("joint_spring", "rotor_inertia")
    )
    assert columns_of(usual) == columns_of(odd) == [(2,)]
    assert usual.steps[0].log_evidence - odd.steps[0].log_evidence == pytest.approx(np.log(5.0))


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_is_a_hundred_times_less_likely_is_not_possible(seed):
    A, noise = drawn(seed, 5)
    noise -= A @ np.linalg.lstsq(A, noise, rcond=None)[0]
    search = Stepwise(LinearLikelihood(A, A[:, 2] + noise, [Columns(k) for k in range(5)]), 1000, MOST)
    found = search.run()
    assert [one.candidate.hypothesis.joints for one, _ in search.possible(found.base)] == [(2,)]
    # One number in eighty blocks, one place, a thousand families.
    assert search.possible(found.base)[0][1] == pytest.approx(0.5 * np.log(16 * BLOCKS) + np.log(1000.0))
    assert search.possible(found.final) == []


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_trials_held_back_contradict_is_not_possible(seed):
    """It explains much of what is learnt from, and the opposite is true of the other half."""
    A, noise = drawn(seed, 3)
    way = np.where(np.arange(N) < N // 2, 1.0, -1.0)
    search = Stepwise(LinearLikelihood(A, way * A[:, 1] + noise, [Columns(1)]), 1, MOST)
    assert search.possible(search.run().base) == []


class TiedAtTheEnd(LinearLikelihood):
    """When no more is found, unfitted trials are as likely without a cause as with it."""

    def options(self, fit):
        found = super().options(fit)
        self.is_over = not found
        return found

    def without(self, fit, place):
        smaller = super().without(fit, place)
        return replace(smaller, residual=fit.residual) if self.is_over else smaller


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_a_cause_is_held_against_unfitted_trials_once(seed):
    A, noise = drawn(seed, 1)
    found = Stepwise(TiedAtTheEnd(A, A[:, 0] + noise, [Columns(0)]), 1, MOST).run()
    assert columns_of(found) == [(0,)]


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_was_sought_elsewhere_is_judged_as_any_cause(seed):
    A, noise = drawn(seed, 3)
    likelihood = LinearLikelihood(A, A[:, 0] + A[:, 1] + noise, [Columns(0)])
    search = Stepwise(likelihood, 1, MOST)
    found = search.run()
    more = search.extended(found, likelihood.fit_of(*found.final.candidate.model.hypotheses, Columns(1)))
    assert more is not None and columns_of(more) == [(0,), (1,)]
    assert more.steps[1].before.candidate.model.hypotheses == found.final.candidate.model.hypotheses
    assert more.steps[1].log_evidence > 0.0
    assert search.extended(found, likelihood.fit_of(*found.final.candidate.model.hypotheses, Columns(2))) is None


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_later_ones_make_needless_goes(seed):
    """A blend of two true columns comes first, and explains nothing once both of them are known."""
    A, noise = drawn(seed, 5)
    A[:, 4] = A[:, 0] + A[:, 1] + 0.5 * A[:, 4]
    found = search(A, 2.0 * (A[:, 0] + A[:, 1]) + 0.5 * noise)
    assert set(columns_of(found)) == {(0,), (1,)}
    assert found.first[0].candidate.hypothesis.joints == (4,)


def hiding(seed):
    """Return columns of which two explain next to nothing alone, and much together."""
    A, noise = drawn(seed, 5)
    A[:, 1] = -A[:, 0] + 0.05 * A[:, 1]
    return A, 12.0 * (A[:, 0] + A[:, 1]) + noise


def test_two_that_hide_each_other_are_found_in_a_pair():
    A, y = hiding(3)
    found = search(A, y)
    assert set(columns_of(found)) == {(0,), (1,)}
    assert found.steps[0].log_evidence == found.steps[1].log_evidence


def test_no_pair_is_sought_where_little_is_wrong():
    A, y = hiding(3)
    assert columns_of(search(A, y, wrong=False)) == []


def nearly(column, seed, much=0.02):
    return column + much * np.random.default_rng(seed).normal(size=len(column))


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_of_equals_the_one_with_fewest_numbers_is_taken(seed):
    """Three columns explain a little more than one that is nearly the same, by no more than scatter does."""
    A, noise = drawn(seed, 5)
    A[:, 3] = nearly(A[:, 2], seed + 1)
    lean, wide = Columns(3), Columns(0, 1, 2)
    found = search(A, A[:, 2] + noise, wide, lean, Columns(4))
    (step,) = found.steps
    assert step.hypothesis is lean
    assert [one.candidate.hypothesis for one in step.equals] in ([wide], [])
    assert penalised_log_likelihood(step.fit) >= penalised_log_likelihood(step.before)


def test_an_equal_is_kept_beside_the_cause_and_what_is_worse_is_not():
    A, noise = drawn(5, 6)
    A[:, 3], A[:, 4] = nearly(A[:, 2], 1), nearly(A[:, 2], 2, 0.7)
    found = search(A, 2.0 * A[:, 2] + noise)
    (step,) = found.steps
    (equal,) = step.equals
    assert {step.hypothesis.joints, equal.candidate.hypothesis.joints} == {(2,), (3,)}
    assert not is_better(step.fit, equal) and not is_better(equal, step.fit)
    assert len(step.options) == 6


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_does_not_help_where_nothing_was_fitted_is_no_cause(seed):
    A, noise = drawn(seed, 4)
    sign = np.where(np.arange(N) < N // 2, 1.0, -1.0)
    y = 0.7 * A[:, 1] * sign + 1.5 * A[:, 2] + noise
    assert columns_of(search(A, y)) == [(2,)]
    # Where all trials may be learnt from none is asked.
    assert columns_of(search(A, A[:, 1] + noise, learnt=1.0)) == [(1,)]


@pytest.mark.parametrize("most", [0, 1, 2])
def test_no_more_are_sought_than_may_be(most):
    A, noise = drawn(7, 4)
    found = search(A, A @ np.arange(1.0, 5.0) + noise, most=most)
    assert columns_of(found) == [(3,), (2,)][:most]


def test_a_model_that_leaves_noise_alone_is_asked_for_no_more():
    A, noise = drawn(8, 4)
    y = 3.0 * A[:, 0] + 0.4 * A[:, 1] + noise
    assert columns_of(search(A, y, exact=1.5)) == [(0,)]
    assert columns_of(search(A, y)) == [(0,), (1,)]


def test_every_accepted_model_is_weighed_anew_and_progress_is_told():
    A, noise = drawn(9, 4)
    likelihood = LinearLikelihood(A, A[:, 0] + 2.0 * A[:, 1] + noise, [Columns(k) for k in range(4)])
    counted: list[int] = []
    Stepwise(likelihood, 4, MOST, counted.append).run()
    assert counted == [1, 2]
    assert likelihood.weighed >= 2


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_two_that_cancel_each_other_are_not_both_causes(seed):
    """Nearly the same column twice: their difference may be significant, but neither has a size."""
    A, noise = drawn(seed, 2)
    A[:, 1] = A[:, 0] + 1e-3 * A[:, 1]
    assert len(columns_of(search(A, A[:, 0] + noise))) == 1


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_stood_in_for_two_is_exchanged_for_the_one_it_stood_for(seed):
    """Two numbers explain nearly all of a true column, and some of another; beside that one fewer do as well."""
    A, noise = drawn(seed, 4)
    A[:, 2] = A[:, 0] + 0.3 * A[:, 1]
    A[:, 3] *= 0.01
    found = search(A, A[:, 0] + 0.6 * A[:, 1] + 0.3 * noise, Columns(2, 3), Columns(0), Columns(1))
    assert set(columns_of(found)) == {(0,), (1,)}


class Entangled(LinearLikelihood):
    """One by which a column has no size beside any other, as one that scatters much more beside it."""

    def is_significant(self, fit):
        own = [one.joints for one in fit.candidate.model.hypotheses]
        return super().is_significant(fit) and not ((2,) in own and len(own) > 1)


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_what_has_no_size_beside_a_later_cause_is_exchanged(seed):
    """A blend of two true columns comes first; beside either of them it stands for the other, without a size."""
    A, noise = drawn(seed, 4)
    A[:, 2] = A[:, 0] + 0.4 * A[:, 1] + 0.3 * A[:, 2]
    y, tried = A[:, 0] + 0.8 * A[:, 1] + 0.5 * noise, [Columns(k) for k in range(4)]
    found = Stepwise(Entangled(A, y, tried, wrong=False), len(tried), MOST).run()
    assert found.first[0].candidate.hypothesis.joints == (2,)
    assert set(columns_of(found)) == {(0,), (1,)}


class Recounted(LinearLikelihood):
    """One by which one column is of no use where all trials are fitted."""

    def everywhere(self, fit):
        kept = [one for one in fit.candidate.model.hypotheses if one.joints != (2,)]
        whole = self.fit_of(*kept, everywhere=True)
        return replace(whole, candidate=replace(whole.candidate, model=fit.candidate.model))


@pytest.mark.parametrize("first", [2.0, 0.0])
@pytest.mark.parametrize(("learnt", "found"), [(0.5, [(1,)]), (1.0, [(1,), (2,)])])
def test_a_cause_needs_evidence_if_all_trials_are_fitted_too(first, learnt, found):
    A, noise = drawn(7, 4)
    y = first * A[:, 1] + 0.8 * A[:, 2] + noise
    found = found if first else found[1:]
    tried = [Columns(k) for k in range(4)]
    likelihood = Recounted(A, y, tried, learnt=learnt)
    assert columns_of(Stepwise(likelihood, len(tried), MOST).run()) == found
    plain = LinearLikelihood(A, y, tried, learnt=learnt)
    assert columns_of(Stepwise(plain, len(tried), MOST).run()) == ([(1,), (2,)] if first else [(2,)])


class Replacing(LinearLikelihood):
    """One by which a later column makes an earlier one needless, and alone explains nothing by its own weights."""

    alone = True

    def options(self, fit):
        found = super().options(fit)
        return (
            found
            if fit.candidate.model.hypotheses
            else [one for one in found if one.candidate.hypothesis.joints != (2,)]
        )

    def reweighted(self, fit):
        own = [one.joints for one in fit.candidate.model.hypotheses]
        return super().reweighted(fit if self.alone or own != [(2,)] else self.unexplained(fit))

    def unexplained(self, fit):
        """Return a fit that leaves what no cause does."""
        return replace(fit, residual=self.fit_of().residual)


@pytest.mark.parametrize(("alone", "found"), [(True, [(2,)]), (False, [(1,)])])
def test_what_makes_a_cause_needless_explains_it_under_its_own_weights(alone, found):
    A, noise = drawn(7, 4)
    A[:, 2] = A[:, 1] + 0.5 * A[:, 2]
    tried = [Columns(k) for k in range(4)]
    likelihood = Replacing(A, 2.0 * A[:, 2] + noise, tried, learnt=1.0)
    likelihood.alone = alone
    assert columns_of(Stepwise(likelihood, len(tried), MOST).run()) == found
