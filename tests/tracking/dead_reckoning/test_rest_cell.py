"""What a cell of readings is judged by, against numbers worked out by hand."""

import numpy as np
import pytest

from tracking.dead_reckoning.rest_cell import _share, _strays, look_at


def test_a_cell_s_excess_is_its_mean_beyond_gravity() -> None:
    cell, excess = np.array([[1.0, 5.0], [1.0, 5.25], [4.0, 4.0]]), np.empty(2)
    assert look_at(cell, np.array([0.5, -1.0]), np.inf, excess) == 0.25
    np.testing.assert_allclose(excess, [1.5, 5.75])
    assert look_at(cell, np.zeros(2), 0.1, excess) == 0.1


def test_a_trend_is_about_the_second_half_less_the_first() -> None:
    mean, trend = np.empty(2), np.empty(2)
    halves = np.repeat([-1.0, 0.0, 1.0], [12, 1, 12])
    _strays(np.column_stack([halves, np.full(25, 3.0)]), np.array([0.25, 1.0]), mean, trend)
    np.testing.assert_allclose(mean, [-0.25, 2.0])
    np.testing.assert_allclose(trend, [2.0 * 78.0 / 75.0, 0.0], atol=1e-12)


def test_the_worst_channel_and_contrast_count() -> None:
    """A contrast is of two channels, and may be off by the steps that gravity is rounded to besides."""
    mean, slack = np.array([3.0, -4.0, 0.5]), np.array([1.0, 1.5, 0.0])
    contrast, rounded = np.array([[-1.0, 0.0, 1.0], [0.0, 1.0, -1.0]]), np.array([0.0, 1.0])
    share = _share(mean, 2.0, 0.25, slack, contrast, rounded)
    assert share == pytest.approx(4.5 / (np.sqrt(2.0) * 2.25))
    assert _share(mean, 2.0, 0.25, 0.0 * slack, contrast[:1], rounded) == pytest.approx(2.0)
    assert _share(mean, 2.0, 0.25, slack, contrast[:0], rounded) == pytest.approx(1.25)
