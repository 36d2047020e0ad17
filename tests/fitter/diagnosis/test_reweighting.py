"""The noise of the equations is measured under the model that explains them."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.trials import to_trials
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import noise_of_angles, run_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.reweighting import will_do
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression() -> Regression:
    trials = to_trials(swings((), trials=8, seed=2), cutoff_hz=25.0)
    return Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))


def test_noise_is_that_of_the_angles_times_the_mass(regression: Regression) -> None:
    x = regression.solve(Model(), regression.learning)
    right = regression.weighting_under(Model(), x)
    assert will_do(regression.weighting, right)
    motions = regression.learning
    thinned = np.mean([motion.trial.dt_s / motion.dt_s for motion in motions])
    angle = noise_of_angles([motion.trial for motion in motions])
    faster = replace(motions[0], ddq=motions[0].ddq + 1.0)
    one, other = (regression.equations.left(Model(), x, motion) for motion in (motions[0], faster))
    expected = thinned * (np.mean(one - other) * angle) ** 2
    np.testing.assert_allclose(right.acceleration_noise.ravel(), expected, rtol=0.15)


@pytest.mark.parametrize(
    ("factor", "good"), [(0.1, False), (0.6, False), (1.0, True), (10.0, False), (1e-5, True)]
)
def test_a_filter_that_takes_the_noise_for_less_is_found_out(
    regression: Regression, factor: float, good: bool
) -> None:
    """What would need masses beyond all sense is left as it is."""
    used = regression.weighting
    wrong = replace(used, acceleration_noise=factor * used.acceleration_noise)
    other = regression.weighted_by(wrong)
    right = other.weighting_under(Model(), other.solve(Model(), other.learning))
    assert will_do(wrong, right) == good
    np.testing.assert_allclose(right.acceleration_noise, used.acceleration_noise, rtol=0.05)


def test_noise_that_couples_joints_is_looked_at_along_every_direction() -> None:
    """Each joint alone has as much as it was taken to have; what they have not in common is ten times as much."""
    torque = np.full(2, 1e-6)
    anything = np.full(2, np.inf)
    used, right = (Weighting(torque, np.array([[1.0, c], [c, 1.0]]), 18.0, 3, anything) for c in (0.99, 0.9))
    assert not will_do(used, right)
    assert will_do(used, used)
    loud = Weighting(np.full(2, 1e6), right.acceleration_noise, 18.0, 3, anything)
    assert will_do(replace(used, torque_noise=loud.torque_noise), loud)  # it is drowned by the torque's own
