"""The background whitens residuals."""

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Background, Rows
from fitter.diagnosis.torque.background_fit import estimated
from tests.fitter.diagnosis.torque.residuals import trial


def background(**changed: float) -> Background:
    numbers = {
        "std": 0.05, "time_constant_s": 0.3, "ringing": 0.02, "ringing_rad_s": 20.0, "damping_ratio": 0.3,
        "white": 0.01, "angle": 1e-6, "degrees_of_freedom": 30.0, "contact": 0.03,
    }  # fmt: skip
    return Background(**{**numbers, **changed}, in_proportion=np.array([0.1]), proportion_s=np.array([0.5]))


def rows(r: np.ndarray, known: np.ndarray | None = None) -> Rows:
    n = len(r)
    t = 0.02 * np.arange(n)
    known = np.ones(n, dtype=bool) if known is None else known
    reversing = (np.arange(n) % 7 == 0).astype(np.float64)
    noises = 0.005, 1e-6, *np.zeros((2, n)), reversing, r
    return Rows(t, r, known, np.cos(3.0 * t)[:, None], 1, 25.0, *noises)


def covariance(model: Background, part: Rows) -> np.ndarray:
    """Return the covariance of eq. (m.1), (n, n), from its autocovariances."""
    lag = np.abs(part.t[:, None] - part.t)
    w, z = model.ringing_rad_s, model.damping_ratio
    fast = w * np.sqrt(1.0 - z * z)
    ringing = np.exp(-z * w * lag) * (np.cos(fast * lag) + z * w / fast * np.sin(fast * lag))
    s = part.signals[:, 0]
    in_proportion = model.in_proportion[0] ** 2 * np.outer(s, s) * np.exp(-lag / model.proportion_s[0])
    difference = np.array([6.0, -4.0, 1.0]) * (part.angle_noise**2 + model.angle**2) / part.step_s**4
    angle = np.select([np.round(lag / part.step_s) == k for k in range(3)], list(difference))
    white = np.diag(part.torque_noise**2 + model.white**2 + (model.contact * part.reversing) ** 2)
    stationary = model.std**2 * np.exp(-lag / model.time_constant_s) + model.ringing**2 * ringing
    return stationary + in_proportion + angle + white


def test_innovations_are_those_of_the_covariance():
    model, r = background(), np.random.default_rng(1).normal(size=60)
    known = np.ones(60, dtype=bool)
    known[20:27] = False
    part = rows(r, known)
    kalman = model.filtered(part)
    e = kalman.innovations(r)
    S = covariance(model, part)[np.ix_(known, known)]
    L = np.linalg.cholesky(S)
    assert np.linalg.solve(L, r[known]) == pytest.approx(e[known], abs=1e-8)
    assert np.sum(np.log(kalman.S[known])) == pytest.approx(np.linalg.slogdet(S)[1])
    assert np.all(e[~known] == 0.0)


def test_a_block_of_unlikely_rows_has_the_least_density():
    part = trial(np.random.default_rng(3)).rows(0)
    model = estimated([part])
    part.r[50:75] += 0.5 * (-1.0) ** np.arange(25)
    part.known[100:125] = False
    density = model.mean_log_density(part, 25 * part.step_s)
    assert np.all(np.isnan(density[100:125]))
    assert np.nanargmin(density) == 50
    np.testing.assert_array_equal(density[50:75], density[50])
