"""Constants where readings' errors are not independent: slopes, dispersion, and what is added to claims."""

import numpy as np
import pytest

from tests.tracking.smoother.test_smoothing_pass import Problem
from tracking.model.observation import ABSENT, MOUNTING
from tracking.smoother.consider_covariance import (
    Considered,
    _held,
    consider,
    constants,
    dispersion,
    sensitivities,
)
from tracking.smoother.linearised import Linearised

#: Without the rounding that a prior of 1e-5 brings to differences.
CASES = ["plain", "mountings", "discrepancy", "gyroscopes"]


def linearised(arm, case):
    """Return a problem whose offsets do not wander: then they are constants, too."""
    one = Problem(arm, case)
    return Linearised(one.of, one.course._replace(wander=0.0 * one.course.wander), one.at, one.x0, one.P0)


@pytest.mark.parametrize("case", CASES)
def test_slopes_and_responses_make_up_what_the_smoother_claims(dd_arm, case):
    """Information adds up over the instants; the variance of an angle is that with constants held, and theirs."""
    problem = linearised(dd_arm, case)
    columns = constants(problem.of, problem.P0)
    own = np.ix_(columns, columns)
    unit = np.sqrt(np.diag(problem.P0)[columns])
    held = _held(problem, columns)
    _, precision, slopes, response = sensitivities(problem, columns, unit)
    found, _, P = problem.smoothed()
    known = P[own] / np.outer(unit, unit)
    information = np.einsum("kci,kc,kcj->ij", slopes, precision, slopes)
    before = problem.P0[own] / np.outer(unit, unit)
    np.testing.assert_allclose(
        np.linalg.inv(np.linalg.inv(before) + information), known, rtol=1e-5, atol=1e-6 * np.abs(known).max()
    )
    theirs = np.einsum("kjp,pq,kjq->kj", response, known, response)
    alone = held.angle_variance_of(held.smoothed()[0])
    np.testing.assert_allclose(alone + theirs, problem.angle_variance_of(found), rtol=1e-5)


def test_constants_are_those_of_which_something_is_to_be_learnt(dd_arm):
    problem = linearised(dd_arm, "AC-coupled, sought")
    of, P0 = problem.of, problem.P0.copy()
    lengths = of.length_column[of.length_column != ABSENT]
    P0[lengths, :], P0[:, lengths] = 0.0, 0.0  # they are known exactly
    found = set(constants(of, P0).tolist())
    offsets = 3 * problem.n_joint + np.arange(3 * of.link.size).reshape(-1, 3)
    assert found >= set(offsets[of.corner == 0.0].ravel().tolist())
    assert not found & set(offsets[of.corner > 0.0].ravel().tolist())
    mounted = {int(first) + k for first in of.mounting_column for k in range(MOUNTING)}
    assert found - set(offsets.ravel().tolist()) == mounted


@pytest.mark.parametrize("times", [1.0, 4.0, 25.0])
def test_dispersion_is_by_how_much_the_scores_vary_more(times):
    """Scores of stretches about the truth, at what all of them and the prior make most probable."""
    rng, n_stretch, size = np.random.default_rng(3), 8, 12
    found = []
    for _ in range(40):
        roots = rng.standard_normal((n_stretch, size, 5))  # each shows less than there are constants
        information = np.einsum("bik,bjk->bij", roots, roots)
        known = np.linalg.inv(np.eye(size) + information.sum(axis=0))
        raw = np.sqrt(times) * np.einsum("bik,bk->bi", roots, rng.standard_normal((n_stretch, 5)))
        at = known @ (raw.sum(axis=0) + rng.standard_normal(size))
        found.append(dispersion(raw - information @ at, information, known))
    assert min(found) >= 1.0
    assert np.mean(found) == pytest.approx(times, rel=0.2)  # none is less than 1


def test_a_recording_that_the_model_is_right_of_adds_little_and_one_that_it_is_not_much(dd_arm):
    """Readings ten times as noisy as held: the claim grows, and only along what readings say."""
    problem = linearised(dd_arm, "mountings")
    plain = consider(problem, 1e-3)
    noisy = problem.course.readings + 10.0 * np.random.default_rng(0).standard_normal(
        problem.course.readings.shape
    )
    found = consider(problem._replace(course=problem.course._replace(readings=noisy)), 1e-3)
    assert found.dispersion > 3.0 * plain.dispersion
    assert (found.variance >= 0.0).all() and found.variance.max() > 0.0
    before = problem.P0[np.ix_(found.columns, found.columns)]
    after = problem.smoothed()[2][np.ix_(found.columns, found.columns)]
    unit = np.sqrt(np.diag(before))
    shown = (np.linalg.inv(after) - np.linalg.inv(before)) * np.outer(unit, unit)
    scaled = after / np.outer(unit, unit)
    expected = (found.dispersion - 1.0) * scaled @ shown @ scaled
    np.testing.assert_allclose(found.added / np.outer(unit, unit), expected, atol=1e-3 * np.abs(expected).max())


def test_a_state_gets_of_the_constants_what_it_depends_on_them():
    """A state y = 2 c + what is its own."""
    c, own, more = 3.0, 0.5, 7.0
    P = np.array([[4.0 * c + own, 2.0 * c], [2.0 * c, c]])
    one = Considered(np.array([1]), 2.0, np.array([[more]]), np.zeros((0, 1)))
    after = one.added_to(P)
    np.testing.assert_allclose(
        after, np.array([[4.0 * (c + more) + own, 2.0 * (c + more)], [2.0 * (c + more), c + more]])
    )
