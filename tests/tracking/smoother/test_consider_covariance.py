"""Constants where readings' errors are not independent: slopes, dispersion, and what is added to claims."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from tests.tracking.smoother.test_smoothing_pass import Problem
from tracking.model.observation import ABSENT, MOUNTING
from tracking.smoother.consider_covariance import (
    Considered,
    _without,
    consider,
    constants,
    dispersion,
    posterior,
    responses_of,
    slopes_of,
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
    """Information adds up over the instants; the variance of motion is that with constants held, and theirs."""
    problem = linearised(dd_arm, case)
    columns = constants(problem.of, problem.P0)
    own = np.ix_(columns, columns)
    unit = np.sqrt(np.diag(problem.P0)[columns])
    _, precision, slopes = slopes_of(problem, columns, unit)
    response = responses_of(problem, columns, unit)
    found, _, P = problem.smoothed()
    information = np.einsum("kci,kc,kcj->ij", slopes, precision, slopes)
    known = posterior(problem.P0[own] / np.outer(unit, unit), information)
    np.testing.assert_allclose(known, P[own] / np.outer(unit, unit), rtol=1e-5, atol=1e-6 * np.abs(known).max())
    theirs = np.einsum("kjp,pq,kjq->kj", response, known, response)
    alone = problem._replace(P0=_without(problem.P0, columns)).smoothed()[0].variance[:, : 3 * problem.n_joint]
    np.testing.assert_allclose(alone + theirs, found.variance[:, : 3 * problem.n_joint], rtol=1e-5)


@pytest.mark.parametrize("case", CASES)
def test_where_errors_are_independent_constants_are_what_the_smoother_finds(dd_arm, case, monkeypatch):
    """Held there, the motion is the same, and so is what is known after the last reading."""
    monkeypatch.setattr("tracking.smoother.consider_covariance.dispersion", lambda *_: 1.0)
    problem = linearised(dd_arm, case)
    one = consider(problem, 0.05)
    free, x, P = problem.smoothed()
    x0, P0 = one.held(problem.x0, problem.P0)
    held, y, Q = problem._replace(x0=x0, P0=P0).smoothed()
    scale = np.sqrt(np.diag(problem.P0))
    np.testing.assert_allclose(
        (held.states - free.states) / scale, 0.0, atol=1e-5 * np.abs(free.states / scale).max()
    )
    np.testing.assert_allclose((y - x) / scale, 0.0, atol=1e-5 * np.abs(x / scale).max())
    both = one.added_to(Q, P)
    np.testing.assert_allclose(
        both / np.outer(scale, scale), P / np.outer(scale, scale), atol=1e-5 * np.max(P / np.outer(scale, scale))
    )
    moving = slice(0, 3 * problem.n_joint)
    np.testing.assert_allclose(held.variance[:, moving] + one.variance, free.variance[:, moving], rtol=1e-5)


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


def test_readings_whose_errors_are_larger_say_less_of_constants(dd_arm):
    """Ten times as noisy as held: constants are known as if there were a part of the readings."""
    problem = linearised(dd_arm, "mountings")
    plain = consider(problem, 1e-3)
    noise = 10.0 * np.random.default_rng(0).standard_normal(problem.course.readings.shape)
    noisy = problem._replace(course=problem.course._replace(readings=problem.course.readings + noise))
    found = consider(noisy, 1e-3)
    assert found.dispersion > 3.0 * plain.dispersion
    sought = np.concatenate([found.columns, 3 * np.arange(problem.n_joint)])  # with the first angles
    unit, count = np.sqrt(np.diag(problem.P0)[sought]), len(found.columns)
    _, precision, slopes = slopes_of(problem, sought, unit)
    information = np.einsum("kci,kc,kcj->ij", slopes, precision, slopes)
    inverse = np.linalg.inv(problem.P0[np.ix_(sought, sought)] / np.outer(unit, unit))
    inverse += information / found.dispersion
    scale = np.outer(unit, unit)[:count, :count]
    expected = np.linalg.inv(inverse)[:count, :count] * scale
    np.testing.assert_allclose(found.covariance / scale, expected / scale, atol=1e-6)
    assert np.linalg.eigvalsh((found.covariance - plain.covariance) / scale).min() > -1e-9
    assert (found.variance >= plain.variance * (1.0 - 1e-9)).all()


def test_a_state_gets_of_the_constants_what_it_depends_on_them():
    """A state y = 2 c + what is its own; the constant then is less known than the readings had it."""
    c, own, known = 3.0, 0.5, 7.0
    free = np.array([[4.0 * c + own, 2.0 * c], [2.0 * c, c]])
    held = np.array([[own, 0.0], [0.0, 0.0]])
    one = Considered(np.array([1]), 2.0, np.zeros(1), np.array([[known]]), np.zeros((0, 1)))
    np.testing.assert_allclose(one.added_to(held, free), [[4.0 * known + own, 2.0 * known], [2.0 * known, known]])
    x0, P0 = one._replace(moved=np.array([0.1])).held(np.array([1.0, 2.0]), free)
    np.testing.assert_allclose(x0, [1.2, 2.1])
    np.testing.assert_allclose(P0, held, atol=1e-12)


def test_what_was_known_of_the_first_angles_counts_in_full():
    """However little readings count, angles that were given and gravity still say how sensors are turned."""
    problem = linearised(load_arm("dd-arm-vertical"), "mountings")
    angles = 3 * np.arange(problem.n_joint)
    problem.P0[angles, :], problem.P0[:, angles] = 0.0, 0.0
    noise = 0.1 * np.random.default_rng(0).standard_normal(problem.course.readings.shape)
    noisy = problem._replace(course=problem.course._replace(readings=problem.course.readings + noise))
    exact = consider(noisy, 1e-3)
    assert exact.dispersion > 100.0
    P0 = problem.P0.copy()
    P0[angles, angles] = 1e-3**2
    given = consider(noisy._replace(P0=P0), 1e-3)
    np.testing.assert_allclose(np.diag(given.covariance), np.diag(exact.covariance), rtol=0.05)
    unit = np.sqrt(np.diag(P0)[given.columns])
    np.testing.assert_allclose(given.moved / unit, exact.moved / unit, atol=0.02)
