"""The missing torque is smoothed, bridges gaps, and lies within its band."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Background
from fitter.diagnosis.torque.missing_torque import ResidualTorque, missing_torques
from tests.fitter.diagnosis.torque.residuals import coloured, trial

MODEL = Background(0.05, 0.3, 1e-6, 20.0, 0.5, np.full(2, 1e-9), np.ones(2), 1e-6, 1e-9, 30.0)


def noisy(rng: np.random.Generator) -> tuple[np.ndarray, ResidualTorque]:
    """Return a missing torque and its residual with the sensor's noise."""
    part = trial(rng)
    truth = coloured(rng)
    truth = np.convolve(truth, np.ones(3) / 3.0, mode="same")
    r = truth + 0.04 * rng.normal(size=len(truth))
    return truth, replace(part, r=r[:, None], torque_noise=np.array([0.04]))


def test_smoothing_takes_noise_away_and_the_band_holds():
    truth, part = noisy(np.random.default_rng(1))
    (found,) = missing_torques([part], [MODEL])
    miss = found.torque[:, 0] - truth
    assert np.sqrt(np.mean(miss**2)) < 0.8 * 0.04
    assert 0.55 < np.mean(np.abs(miss) < found.band[:, 0]) < 0.95


def test_the_band_widens_where_nothing_is_known():
    _, part = noisy(np.random.default_rng(2))
    known = part.known.copy()
    known[100:150] = False
    (found,) = missing_torques([replace(part, known=known, r=np.where(known, part.r, np.nan))], [MODEL])
    assert np.all(np.isfinite(found.torque))
    assert found.band[125, 0] > 2.0 * found.band[50, 0]
    assert found.band[125, 0] < 1.1 * 0.05


def test_rows_have_two_samples_a_period_of_the_band():
    part = replace(trial(np.random.default_rng(3)), band_hz=6.25)
    part.known[:1] = False
    rows = part.rows(0)
    assert rows.step_s == pytest.approx(0.08)
    assert not rows.known[0]
    assert rows.known[1:].all()
    assert rows.signals.shape == (len(rows.t), 2)
