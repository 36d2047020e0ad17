"""Numbers of a trace: power of the residual torque and the largest error of a simulated angle."""

from types import SimpleNamespace

import numpy as np

from fitter.report.diagnosis_traces import Trace, _kept

Q = np.linspace(0.0, 1.0, 6)[:, None]
MOTION = SimpleNamespace(trial=SimpleNamespace(q=Q))


def test_they_are_those_without_the_causes():
    residual = np.array([[1.0], [np.nan], [2.0], [0.0], [np.nan], [-2.0]])
    trace = Trace(MOTION, [residual, 0.0 * residual], [Q - 0.3, Q])
    assert trace.torque_square == 9.0
    np.testing.assert_allclose(trace.angle_error, 0.3)


def test_an_angle_that_ran_away_is_cut_from_there_on_and_its_error_infinite():
    angles = np.array([[0.0], [10.0], [2e3], [1.0], [np.inf], [0.0]])
    kept = _kept(angles)
    np.testing.assert_array_equal(np.isnan(kept[:, 0]), [False, False, True, True, True, True])
    assert Trace(MOTION, [Q], [kept]).angle_error == np.inf
