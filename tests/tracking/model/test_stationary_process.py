"""Stationary processes, against their differential equations."""

import numpy as np
import pytest
from scipy.linalg import expm

from tracking.model.stationary_process import decay, transition


@pytest.mark.parametrize("rate", [0.0, 1e-9, 0.5, 10.0, 200.0])
def test_a_transition_is_the_matrix_exponential(rate: float) -> None:
    qv, qa, vv, va, av, aa = transition(rate, 0.01)
    F = expm(0.01 * np.array([[0, 1, 0], [0, 0, 1], [0, -(rate**2), -2 * rate]]))
    np.testing.assert_allclose([[1, qv, qa], [0, vv, va], [0, av, aa]], F, rtol=1e-9, atol=1e-12)


def test_a_process_that_decays_keeps_its_variance() -> None:
    x, P = np.array([1.0, 2.0]), np.array([[0.5, 0.1], [0.1, 4.0]])
    decay(x, P, 1, 0.8, 2.0)
    np.testing.assert_allclose(x, [1.0, 1.6])
    np.testing.assert_allclose(P, [[0.5, 0.08], [0.08, 4.0]])
