"""Cosine coefficients of the base's equations: an orthonormal transform, cut at a frequency, in bands."""

import numpy as np
import pytest

from fitter.ground.frequency_rows import FrequencyRows, frequency_rows

DT, N = 0.01, 400
T = (np.arange(N) + 0.5) * DT


def test_a_cosine_is_one_coefficient_at_its_frequency():
    w = np.zeros((N, 6))
    w[:, 2] = np.cos(2.0 * np.pi * 2.5 * T)
    rows = frequency_rows([w[:, :, None]], [w], [DT], 5.0)
    k = int(np.argmax(np.abs(rows.w[:, 2])))
    assert rows.hz[k] == pytest.approx(2.5) and rows.w[k, 2] == pytest.approx(np.sqrt(N / 2.0))
    assert np.sum(rows.w**2) == pytest.approx(rows.w[k, 2] ** 2)
    np.testing.assert_allclose(rows.Y[:, :, 0], rows.w)


def test_both_sides_keep_their_power_up_to_the_corner():
    rng = np.random.default_rng(0)
    trials = [rng.normal(size=(n, 6)) for n in (N, 300)]
    Y = [np.stack([w, 2.0 * w], axis=2) for w in trials]
    rows = frequency_rows(Y, trials, [DT, 0.02], 1e9)
    assert np.sum(rows.w**2) == pytest.approx(sum(np.sum(w**2) for w in trials))
    np.testing.assert_allclose(rows.Y[:, :, 1], 2.0 * rows.w)
    assert rows.trial.tolist() == [0] * N + [1] * 300 and rows.hz.max() < 50.0
    cut = frequency_rows(Y, trials, [DT, 0.02], 5.0)
    assert cut.hz.max() == 5.0 and (cut.trial == 0).sum() == 41  # 0, 1/8, .. 5 Hz
    assert (cut.trial == 1).sum() == 61  # 0, 1/12, .. 5 Hz


def test_bands_double_and_hold_enough():
    hz = np.arange(200) / 8.0
    rows = FrequencyRows(np.zeros((200, 6, 1)), np.zeros((200, 6)), hz, np.zeros(200, dtype=np.intp))
    band = rows.bands()
    counts = np.bincount(band)
    assert np.all(np.diff(band) >= 0) and counts.min() >= 16 and len(counts) > 2
    assert counts[0] == 31  # the first 16 end at 15/8 Hz, the next band begins beyond twice that
    edges = hz[np.flatnonzero(np.diff(band)) + 1]
    assert np.all(edges[1:] > 2.0 * edges[:-1])
    order = np.random.default_rng(0).permutation(200)
    mixed = FrequencyRows(rows.Y, rows.w, hz[order], rows.trial).bands()
    np.testing.assert_array_equal(mixed, band[order])


def test_few_coefficients_are_one_band():
    rows = FrequencyRows(np.zeros((20, 6, 1)), np.zeros((20, 6)), np.arange(20.0), np.zeros(20, dtype=np.intp))
    assert rows.bands().tolist() == [0] * 20
