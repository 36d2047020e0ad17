"""The density of a motion given the torque."""

import numpy as np

from arm.effects.catalogue import catalogue
from fitter.data.trials import to_trials
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.falling_friction import HeldStribeck
from fitter.diagnosis.mass_density import MassDensity
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Regression
from tests.fitter.pendulum import pendulum, swings


def test_two_forms_of_one_effect_at_one_joint_are_kept_apart() -> None:
    trials = to_trials(swings((), trials=2, seed=2), cutoff_hz=25.0)
    regression = Regression(pendulum(), run_of(pendulum(), trials[:1], trials[1:]))
    motions = regression.motions
    mass = MassDensity(regression.equations, motions, 1.0, {one.number: np.ones(1) for one in motions}, np.ones(4))
    width = np.array([0.5])
    fitted = Model().plus(AtJoint(catalogue()["stribeck"], 0), width)
    given = Model().plus(HeldStribeck(0, 0.1), width)
    values = [mass.of(model, regression.solve(model, motions), motions) for model in (Model(), fitted, given)]
    assert np.all(np.isfinite(values))
