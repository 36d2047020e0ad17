"""A direction that annuls noisy rows, and ratios of its components: known truth, and no truth at all."""

import numpy as np
import pytest

from fitter.controller.homogeneous_fit import homogeneous_fit
from fitter.controller.row_noise import RowNoise

TRUTH = np.array([2.0, -1.0, 0.5])


def rows_of(rng, n, signal, sigma):
    """Return rows that the truth annuls, with noise of sigma in each column, and what that noise is."""
    clean = (
        signal * rng.normal(size=(n, 3)) @ np.linalg.svd(TRUTH[None])[2][1:].T @ np.linalg.svd(TRUTH[None])[2][1:]
    )
    return clean + sigma * rng.normal(size=(n, 3)), RowNoise((sigma or 1.0) * rng.normal(size=(40, n, 1, 3)))


def test_rows_without_noise_give_the_direction():
    rng = np.random.default_rng(0)
    rows, noise = rows_of(rng, 100, 1.0, 0.0)
    fit = homogeneous_fit([rows], [noise], 1.0)
    np.testing.assert_allclose(fit.x / fit.x[0], TRUTH / TRUTH[0], rtol=1e-9)
    assert fit.sigma < 1e-9


def test_intervals_hold_the_truth_as_often_as_they_say():
    held, sigmas, unit = 0, [], np.eye(3)
    for seed in range(200):
        rng = np.random.default_rng(seed)
        rows, noise = rows_of(rng, 60, 1.0, 0.3)
        fit = homogeneous_fit([rows], [noise], 1.0)
        _, interval = fit.ratio(unit[0], unit[1])
        assert interval is not None
        held += interval[0] <= -2.0 <= interval[1]
        sigmas.append(fit.sigma)
    assert 180 <= held <= 199  # 95 % of 200, three standard errors
    assert np.mean(sigmas) == pytest.approx(1.0, rel=0.05)


def test_noise_does_not_draw_the_ratio_in():
    """Least squares of the first column on the second is drawn to 0 by noise in the second."""
    rng = np.random.default_rng(5)
    rows, noise = rows_of(rng, 4000, 1.0, 0.5)
    fit, unit = homogeneous_fit([rows], [noise], 1.0), np.eye(3)
    value, interval = fit.ratio(unit[0], unit[1])
    assert interval is not None and interval[1] - interval[0] < 0.6
    assert interval[0] < -2.0 < interval[1] and interval[0] < value < interval[1]


def test_a_ratio_of_which_nothing_is_seen_has_no_interval():
    unit, bounded, held = np.eye(3), 0, 0
    for seed in range(40):
        rows, noise = rows_of(np.random.default_rng(seed), 200, 0.02, 1.0)
        interval = homogeneous_fit([rows], [noise], 1.0).ratio(unit[0], unit[1])[1]
        bounded += interval is not None
        held += interval is None or interval[0] <= -2.0 <= interval[1]
    assert bounded <= 4 and held >= 36  # each happens to one in twenty at most


def test_rows_of_which_two_are_alike_count_for_one():
    rng = np.random.default_rng(4)
    rows, noise = rows_of(rng, 80, 1.0, 0.3)
    widths, unit = [], np.eye(3)
    for alike in (1.0, 2.0):
        interval = homogeneous_fit([rows], [noise], alike).ratio(unit[0], unit[1])[1]
        assert interval is not None
        widths.append(interval[1] - interval[0])
    assert widths[1] / widths[0] == pytest.approx(np.sqrt(2.0), rel=0.05)
