"""Suspects with their numbers, and these taken apart and put together again."""

import numpy as np

from fitter.reading_diagnosis.sensor_hypotheses import (
    USUAL_BIAS_M_S2,
    Fitted,
    SensorHypothesis,
    Suspect,
    with_suspect,
    with_theta,
)
from fitter.reading_diagnosis.suspected_effects import EFFECTS

KINDS = {kind.name: kind for kind in reversed(EFFECTS)}

NOTHING = SensorHypothesis((), (), np.zeros((2, 3)), np.zeros(2, dtype=np.bool_))
BOTH = with_suspect(
    with_suspect(NOTHING, Suspect(KINDS["sensor_scale"], 1), np.ones(3)),
    Suspect(KINDS["gravity_tilt"]),
    np.zeros(2),
)


def test_a_suspect_is_called_as_in_the_catalogue():
    assert [suspect.effect for suspect in BOTH.suspects] == ["sensor_scale", "gravity_tilt"]


def test_numbers_go_to_biases_and_then_to_suspects_in_their_order():
    moved = with_theta(BOTH, np.arange(11.0))
    np.testing.assert_array_equal(moved.bias, np.arange(6.0).reshape(2, 3))
    np.testing.assert_array_equal(moved.values[0], [6.0, 7.0, 8.0])
    np.testing.assert_array_equal(moved.values[1], [9.0, 10.0])
    assert moved.suspects == BOTH.suspects


def test_a_fit_tells_standard_errors_by_suspect_and_what_usual_biases_cost():
    moved = with_theta(BOTH, np.full(11, USUAL_BIAS_M_S2))
    fitted = Fitted(moved, [], 0.0, np.diag(np.arange(11.0) ** 2), np.zeros(0))
    np.testing.assert_allclose(fitted.std(0), [6.0, 7.0, 8.0])
    np.testing.assert_allclose(fitted.std(1), [9.0, 10.0])
    assert np.isclose(fitted.usual, 6.0)
