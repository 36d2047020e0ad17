"""Hypotheses beside a model against plain least squares on the same rows."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import Starts, by_learning, fitted
from fitter.diagnosis.screening import screen
from tests.fitter.diagnosis.searched import swinging

SPRING, DRAG = (JointHypothesis(catalogue()[name], 0) for name in ("joint_spring", "quadratic_drag"))


@pytest.fixture(scope="module")
def regression():
    return swinging(Effect("quadratic_drag", {"drag_N_m_s2": 0.2}, joints=(1,)), trials=6)


def plainly(regression, model, motions):
    """Return the least-squares factors of some motions, and what they leave of every trial."""
    rows = [regression.rows(model, one) for one in motions]
    design, target = np.vstack([one.design for one in rows]), np.concatenate([one.target.ravel() for one in rows])
    x = np.linalg.lstsq(design, target, rcond=None)[0]
    every = [regression.rows(model, one) for one in regression.motions]
    return x, np.array([np.sum((one.target.ravel() - one.design @ x) ** 2) for one in every])


def test_a_fit_is_that_of_least_squares_but_for_the_noise_in_its_columns(regression):
    model = Model().plus(DRAG, np.zeros(0))
    found = fitted(regression, model)
    x, squares = plainly(regression, model, regression.learning)
    assert found.x[-1] == pytest.approx(x[-1], rel=0.02)
    np.testing.assert_allclose(found.squares, squares, rtol=0.1)


def test_the_one_that_explains_most_stands_first(regression):
    base = fitted(regression, Model())
    first, second = screen(regression, base, [SPRING, DRAG], Starts())[:2]
    assert first.hypothesis is DRAG and first.squares.sum() < second.squares.sum() < base.squares.sum() * 1.01
    _, squares = plainly(regression, first.model, regression.learning)
    assert first.squares.sum() == pytest.approx(squares.sum(), rel=0.1)


def test_judging_trials_have_no_say_in_what_the_learning_trials_tell(regression):
    of_all = fitted(regression, Model(), to_all=True)
    np.testing.assert_allclose(by_learning(regression, of_all).x, fitted(regression, Model()).x, rtol=1e-9)
