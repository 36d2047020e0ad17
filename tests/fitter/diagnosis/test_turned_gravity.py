"""Gravity in the plane is no stronger than in space, unless the data says so."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.data.trials import to_trials
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.in_arm import GravityTilt
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.settled import settled
from fitter.diagnosis.turned_gravity import turned
from tests.fitter.pendulum import pendulum, swings

TILT = GravityTilt(catalogue()["gravity_tilt"], ())


@pytest.fixture(scope="module")
def trials():
    return to_trials(swings((), trials=6, seed=2), cutoff_hz=25.0)


def found_in(trials, gravity):
    """Return the regression of a pendulum whose file has another gravity, and its tilt."""
    arm = replace(pendulum(), gravity_m_s2=gravity)
    regression = Regression(arm, run_of(arm, trials[:3], trials[3:]))
    return regression, fitted(regression, Model().plus(TILT, np.array([0.1, 0.1])))


@pytest.fixture(scope="module")
def level(trials):
    return found_in(trials, (0.0, 0.0, -9.81))


def test_a_little_too_much_gravity_is_turned(level):
    """The pendulum hangs in 9.81; what its file calls level is found within its error, and told without."""
    regression, final = level
    numbers = estimates(regression, final)
    error = numbers.effects[0]["gx_m_s2"].std
    pulled = final.model.psi[0] / np.hypot(*final.model.psi[0])
    strong = replace(final.model, psi=((9.81 + error) * pulled,))
    turning = turned(regression, strong, numbers)
    assert turning is not None
    assert len(turning.psi[0]) == 1
    again, of_it = settled(regression, replace(final, model=strong))
    values = [number.value for number in of_it.effects[0].values()]
    assert np.hypot(*values) == pytest.approx(9.81)
    assert again.hypothesis.key == TILT.key
    assert all(number.identifiable for number in of_it.effects[0].values())


def test_weaker_gravity_stays(level):
    regression, final = level
    weak = replace(final.model, psi=(final.model.psi[0] * 9.7 / np.hypot(*final.model.psi[0]),))
    assert turned(regression, weak, estimates(regression, final)) is None


def test_gravity_that_is_surely_stronger_stays(trials):
    """A file that says 5: the data says that there is more, beyond doubt."""
    regression, final = found_in(trials, (3.0, 0.0, -4.0))
    numbers = estimates(regression, final)
    assert turned(regression, final.model, numbers) is None
