"""Readings at an even rate, whatever rate they were taken at."""

import numpy as np
import pytest

from fitter.data.even_rate import evened
from fitter.data.motions import Measured

STEP_S = 2e-3
RNG = np.random.default_rng(3)


def readings_at(t, stamps=None):
    """Return what a sensor reads of a motion of 1 Hz and gravity."""
    a = np.column_stack([np.sin(2.0 * np.pi * t), np.cos(2.0 * np.pi * t), np.full(len(t), 9.8)])
    labels = np.where(t < 1.0, "a", "b")
    return Measured("run", "run.csv", 0, t if stamps is None else stamps, {"a": a}, labels)


@pytest.mark.parametrize(
    "steps",
    [
        np.linspace(STEP_S, 1.03 * STEP_S, 2000),
        np.linspace(STEP_S, 1.3 * STEP_S, 2000),
        RNG.uniform(0.5 * STEP_S, 1.5 * STEP_S, 2000),
    ],
    ids=["drifts slowly", "drifts", "random"],
)
def test_readings_at_a_rate_that_wanders_are_resampled(steps):
    even, dt_s, gaps = evened(readings_at(np.cumsum(steps)))
    assert dt_s == pytest.approx(steps.mean(), rel=1e-3)
    assert gaps == () and [note.kind for note in even.notes] == ["resampled"]
    assert np.diff(even.t) == pytest.approx(dt_s)
    true = readings_at(even.t)
    assert even.columns["a"][8:-8] == pytest.approx(true.columns["a"][8:-8], abs=6e-3)
    assert np.mean(even.labels == true.labels) > 0.999


@pytest.mark.parametrize("jitter", [0.0, 0.2, 0.4])
def test_late_stamps_of_an_even_rate_change_no_reading(jitter):
    t = STEP_S * np.arange(2000)
    given = readings_at(t, t + jitter * STEP_S * RNG.uniform(-1.0, 1.0, len(t)))
    assert evened(given)[0] is given


def test_a_hole_amid_a_wandering_rate_stays_a_gap():
    steps = np.linspace(STEP_S, 1.1 * STEP_S, 2000)
    steps[1000] = 0.1
    even, dt_s, gaps = evened(readings_at(np.cumsum(steps)))
    assert [gap.samples for gap in gaps] == [pytest.approx(0.1 / dt_s, abs=1.5)]
    assert even.t[gaps[0].row] - even.t[gaps[0].row - 1] == pytest.approx(0.1, abs=2.0 * dt_s)
