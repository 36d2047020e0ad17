"""Products of white rows, and their residuals, are those of the rows without what may hold a joint."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.data.trials import to_trials
from fitter.diagnosis.arm_hypotheses import JointZero
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.least_squares import own_square, scaled_lstsq
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of
from fitter.diagnosis.weighting import Columns
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression() -> Regression:
    trials = to_trials(swings((), trials=4, seed=3), cutoff_hz=25.0)
    return regression_of(pendulum(), run_of(pendulum(), trials[:2], trials[2:]))


@pytest.fixture
def columns(regression) -> Columns:
    motion = regression.motions[0]
    white = np.random.default_rng(0).normal(size=(len(regression.rows(Model(), motion).design), 4))
    return Columns(regression.weighting, motion, white)


def test_products_are_those_of_the_freed_columns(regression, columns):
    assert np.any(regression.weighting.axes(regression.motions[0])[1] < 1.0)  # something is lost in part
    np.testing.assert_allclose(columns.gram, columns.freed.T @ columns.freed, rtol=1e-9, atol=1e-9)
    other = Columns(regression.weighting, regression.motions[0], np.sin(columns.white[:, :2]))
    np.testing.assert_allclose(columns.times(other), columns.freed.T @ other.freed, rtol=1e-9, atol=1e-9)


def test_a_column_that_only_holds_a_joint_tells_nothing(regression, columns):
    axes, lost = regression.weighting.axes(regression.motions[0])
    whole = axes[:, np.flatnonzero(lost == 1.0)[:1]]
    both = columns.hstacked(Columns(regression.weighting, regression.motions[0], whole))
    assert np.all(both.gram[-1] == 0.0) and np.all(both.gram[:, -1] == 0.0)
    assert np.all(both.times(columns)[-1] == 0.0)
    np.testing.assert_allclose(both.gram[:-1, :-1], columns.gram, rtol=1e-9)


@pytest.mark.parametrize("known", [False, True])
def test_sums_and_neighbours_are_the_same_whether_or_not_their_parts_are_known(regression, columns, known):
    motion, weighting = regression.motions[0], regression.weighting
    other = Columns(weighting, motion, np.cos(columns.white))
    if known:
        assert columns.held.shape == other.held.shape
    beside, plus = columns.hstacked(other), columns.plus([(0.3, other), (-2.0, columns)])
    np.testing.assert_allclose(beside.freed, np.hstack([columns.freed, other.freed]), atol=1e-9)
    np.testing.assert_allclose(plus.freed, 0.3 * other.freed - columns.freed, atol=1e-9)


@pytest.mark.parametrize(
    "hypothesis", [JointHypothesis(catalogue()["cogging"], 0), JointZero(catalogue()["joint_zero"], (0,))]
)
def test_what_factors_leave_is_what_the_freed_equations_leave(regression, hypothesis):
    model = Model().plus(hypothesis, np.array([0.4]))
    x = regression.solve(model, regression.learning)
    for motion in regression.motions:
        rows = regression.rows(model, motion)
        left = rows.target.ravel() - rows.design @ x
        np.testing.assert_allclose(rows.residual(x).ravel(), left, atol=1e-8 * np.abs(rows.target).max())
        assert rows.sum_of_squares(x) == pytest.approx(left @ left, rel=1e-9)
        np.testing.assert_allclose(rows.rhs, rows.design.T @ rows.target.ravel(), rtol=1e-7, atol=1e-6)


def test_the_last_columns_own_square_is_what_others_leave_of_it(columns):
    others, last = columns.freed[:, :-1], columns.freed[:, -1]
    own = last - others @ scaled_lstsq(others, last)
    assert own_square(columns.gram) == pytest.approx(own @ own, rel=1e-9)
    twice = np.hstack([columns.freed, columns.freed[:, :1]])
    assert own_square(twice.T @ twice) == pytest.approx(0.0, abs=1e-9 * float(last @ last))
