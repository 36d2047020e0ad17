"""What moves a link on which no motor pulls, against the arm that was simulated."""

import numpy as np
import pytest

from arm.newton_euler import bias_torque, mass_matrix
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.least_squares import ROUNDED
from fitter.diagnosis.link_forces import free_link
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def learnt():
    trials = to_trials(swings((), trials=4, seed=1), cutoff_hz=25.0)
    regression = regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))
    return regression, fitted(regression, Model())


def test_inertia_and_weight_are_those_of_the_arm(learnt):
    regression, candidate = learnt
    motion = regression.motions[0]
    link = free_link(regression.equations, candidate, motion, 0)
    truth = pendulum()
    np.testing.assert_allclose(link.inertia, mass_matrix(truth, motion.q)[:, 0, 0], rtol=0.02)
    weight = bias_torque(truth, motion.q, np.zeros_like(motion.dq))[:, 0]
    np.testing.assert_allclose(link.resistance, weight, atol=0.02 * np.abs(weight).max())
    assert 0.0 < link.lacking < 0.01 * np.abs(motion.u).max()


def test_of_a_model_without_inertia_nothing_is_known(learnt):
    regression, candidate = learnt
    weightless = type(candidate)(candidate.model, np.zeros_like(candidate.x) - ROUNDED, candidate.squares)
    assert free_link(regression.equations, weightless, regression.motions[0], 0) is None
