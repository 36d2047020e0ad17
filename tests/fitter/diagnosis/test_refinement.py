"""The search for psi ends where nothing near leaves less, though its slopes leave the noise as it is."""

import numpy as np
import pytest
import scipy.optimize

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.arm_hypotheses import JointZero
from fitter.diagnosis.drive_hypotheses import Lag
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Hypothesis, Model
from fitter.diagnosis.refinement import refined
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings

_ZERO = Effect("joint_zero", {"offset_rad": 0.2}, joints=(1,))


@pytest.fixture(scope="module")
def regression() -> Regression:
    trials = to_trials(swings((_ZERO,), trials=6, seed=5), cutoff_hz=25.0)
    return regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))


@pytest.mark.parametrize(
    ("hypothesis", "start", "around"),
    [
        (JointZero(catalogue()["joint_zero"], (0,)), 0.0, (-0.4, 0.4)),
        (JointHypothesis(catalogue()["cogging"], 0), 2.0, (1.5, 2.5)),
        (Lag(catalogue()["actuator_lag"], (0,)), 0.02, (1e-4, 0.1)),
    ],
)
def test_it_ends_where_least_is_left(regression: Regression, hypothesis: Hypothesis, start: float, around):
    def left(psi: float) -> float:
        model = Model().plus(hypothesis, np.array([psi]))
        r = regression.residuals(model, regression.solve(model, regression.learning), regression.learning)
        return float(r @ r)

    found = float(refined(regression, Model().plus(hypothesis, np.array([start])), regression.learning).flat[0])
    best = scipy.optimize.minimize_scalar(left, bounds=around, method="bounded", options={"xatol": 1e-7})
    assert left(found) <= best.fun * (1.0 + 1e-5)


def test_what_is_held_stays(regression: Regression):
    zero, lag = JointZero(catalogue()["joint_zero"], (0,)), Lag(catalogue()["actuator_lag"], (0,))
    model = Model().plus(zero, np.array([0.05])).plus(lag, np.array([0.02]))
    assert refined(regression, model, regression.learning, held=1).psi[0] == [0.05]
    assert refined(regression, model, regression.learning, held=2) is model


def test_where_masses_vanish_psi_stays(regression: Regression, monkeypatch):
    lag = Lag(catalogue()["actuator_lag"], (0,))
    model = Model().plus(lag, np.array([0.02]))
    monkeypatch.setattr(regression, "residuals", lambda *_: np.full(4, np.inf))
    assert refined(regression, model, regression.learning) is model
