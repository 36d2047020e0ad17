"""The background is estimated from residuals, and whitens them."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Background, Rows, estimated, log_likelihood
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
    return Rows(t, r, known, np.cos(3.0 * t)[:, None], 1, 25.0, 0.005, 1e-6, *np.zeros((2, n)), reversing)


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


def test_the_size_and_the_time_of_a_process_are_found():
    rng = np.random.default_rng(2)
    parts = [trial(rng).rows(0) for _ in range(4)]
    found = estimated(parts)
    noiseless = background(ringing=1e-5, white=0.01, contact=1e-6)
    truth = replace(noiseless, in_proportion=np.full(2, 1e-6), proportion_s=np.ones(2))
    assert np.hypot(found.std, found.ringing) == pytest.approx(0.05, rel=0.35)
    assert found.degrees_of_freedom > 8.0
    gained = sum(log_likelihood(found, [part]) - log_likelihood(truth, [part]) for part in parts)
    assert gained > 0.0


def test_an_estimate_goes_on_from_another():
    part = trial(np.random.default_rng(3)).rows(0)
    first = estimated([part])
    again = estimated([part], first)
    assert log_likelihood(again, [part]) >= log_likelihood(first, [part]) - 0.1


@pytest.mark.filterwarnings("error")
def test_an_arm_that_swings_freely_has_no_errors_of_its_torque():
    free = replace(trial(np.random.default_rng(4)), torque=np.zeros((250, 1))).rows(0)
    found = estimated([free])
    again = estimated([free], found)
    assert np.all(again.in_proportion == 0.0)
    assert np.isfinite(log_likelihood(again, [free]))


def test_a_block_of_unlikely_rows_has_the_least_density():
    part = trial(np.random.default_rng(3)).rows(0)
    model = estimated([part])
    part.r[50:75] += 0.5 * (-1.0) ** np.arange(25)
    part.known[100:125] = False
    density = model.mean_log_density(part, 25 * part.step_s)
    assert np.all(np.isnan(density[100:125]))
    assert np.nanargmin(density) == 50
    np.testing.assert_array_equal(density[50:75], density[50])


def test_what_strikes_where_the_torque_changes_its_sign_is_found():
    rng = np.random.default_rng(6)
    parts = [trial(rng).rows(0) for _ in range(4)]
    for part in parts:
        part.r[:] += 0.5 * part.reversing * rng.normal(size=len(part.r))
    found = estimated(parts)
    assert found.contact == pytest.approx(0.5, rel=0.35)
    assert np.hypot(found.std, found.ringing) == pytest.approx(0.05, rel=0.5)
