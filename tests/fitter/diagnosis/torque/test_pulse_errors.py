"""A pulse's errors against those of linear regression, and where its start is unseen."""

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Background
from fitter.diagnosis.torque.pulse_column import in_rows
from fitter.diagnosis.torque.pulse_errors import place_errors
from tests.fitter.diagnosis.torque.residuals import trial

NU = 1e6  # as good as normal
MODEL = Background(0.05, 0.3, 1e-6, 20.0, 0.5, np.full(2, 1e-9), np.ones(2), 1e-6, 1e-9, NU, 1e-9)
PLACE, SIZE = (2.0, 0.4, "rectangular"), 0.8


def test_what_is_seen_is_known_as_by_regression_on_start_duration_and_size():
    rows = trial(np.random.default_rng(4)).rows(0)
    kalman = MODEL.filtered(rows)
    covariance, _ = place_errors(rows, kalman, NU, PLACE, SIZE, (0.0, 0.0))
    (start_s, duration_s, form), step = PLACE, 0.01
    moved = [((step, 0.0), (-step, 0.0)), ((0.0, step), (0.0, -step))]
    shapes = [[in_rows(rows, start_s + s, duration_s + d, form) for s, d in pair] for pair in moved]
    slopes = [SIZE * (ahead - behind) / (2.0 * step) for ahead, behind in shapes]
    J = np.stack([kalman.innovations(column) for column in [*slopes, in_rows(rows, *PLACE)]], axis=1)
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), np.sqrt(np.diag(np.linalg.inv(J.T @ J))), rtol=0.05)


def test_an_unseen_start_is_uniform_and_the_duration_with_it():
    rows = trial(np.random.default_rng(4)).rows(0)
    kalman = MODEL.filtered(rows)
    seen, _ = place_errors(rows, kalman, NU, PLACE, SIZE, (0.0, 0.0))
    covariance, _ = place_errors(rows, kalman, NU, PLACE, SIZE, (0.6, 0.0))
    assert covariance[0, 0] == pytest.approx(0.6**2 / 12.0)
    assert covariance[1, 1] == pytest.approx(covariance[0, 0] + seen[0, 0], rel=0.2)  # both ends alike
