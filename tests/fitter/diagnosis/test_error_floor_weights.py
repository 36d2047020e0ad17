"""The noise of the equations is measured under the model that explains them."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.cutoff import noise_of_angles
from fitter.diagnosis.error_floor import reweighted
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from tests.fitter.diagnosis.searched import swinging


@pytest.fixture(scope="module")
def regression() -> Regression:
    return swinging()


def test_noise_is_that_of_the_angles_times_the_mass(regression: Regression) -> None:
    motions = regression.learning
    x = regression.solve(Model(), motions)
    right = reweighted(
        regression.equations, regression.weighting, Model(), x, regression.motions, regression.noisier
    )
    thinned = np.mean([motion.trial.dt_s / motion.dt_s for motion in motions])
    angle = noise_of_angles([motion.trial for motion in motions])
    faster = replace(motions[0], ddq=motions[0].ddq + 1.0)
    one, other = (regression.equations.residual_torque(Model(), x, motion) for motion in (motions[0], faster))
    expected = thinned * (np.mean(one - other) * angle) ** 2
    np.testing.assert_allclose(right.acceleration_noise.ravel(), expected, rtol=0.15)


@pytest.mark.parametrize("factor", [1e-5, 0.1, 0.6, 1.0, 10.0])
def test_whatever_noise_was_assumed_the_right_one_is_found(regression: Regression, factor: float) -> None:
    used = regression.weighting
    wrong = replace(used, acceleration_noise=factor * used.acceleration_noise)
    other = regression.weighted_by(wrong)
    x = other.solve(Model(), other.learning)
    right = reweighted(other.equations, wrong, Model(), x, other.motions, other.noisier)
    np.testing.assert_allclose(right.acceleration_noise, used.acceleration_noise, rtol=0.05)
    np.testing.assert_array_equal(right.torque_noise, used.torque_noise)
