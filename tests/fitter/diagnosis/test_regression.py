"""White rows: what is left of a true model is noise of variance 1, and the parameters come back."""

import numpy as np
import pytest

from arm.base_parameters import base_parameters
from arm.regressor import standard_parameters
from fitter.data.trials import to_trials
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Model, Regression, scaled_lstsq
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression():
    trials = to_trials(swings((), trials=8, seed=2), cutoff_hz=25.0)
    return Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))


def test_what_is_left_of_the_true_model_has_the_variance_of_noise(regression):
    x = regression.solve(Model(), regression.learning)[0]
    left = regression.squares(Model(), x)
    told = np.array([regression.weighting.told(motion) for motion in regression.motions])
    assert 0.5 < left[4:].sum() / told[4:].sum() < 2.0


def test_base_parameters_come_back(regression):
    x = regression.solve(Model(), regression.learning)[0]
    base = base_parameters(pendulum())
    np.testing.assert_allclose(x, base.combination @ standard_parameters(pendulum()), rtol=0.02, atol=0.02)


def test_dependent_columns_get_the_shortest_answer():
    rng = np.random.default_rng(0)
    A = rng.normal(size=(50, 2))
    A = np.column_stack([A, A[:, 0]])
    x = scaled_lstsq(A, A[:, 0] + A[:, 1])
    np.testing.assert_allclose(x, [0.5, 1.0, 0.5], atol=1e-6)
