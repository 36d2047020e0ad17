"""The grid of a long motion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.data.grid import grid_of
from fitter.data.motions import Measured
from limbcal.errors import DataError


def rows(t):
    return Measured("run", "run.csv", 0, t, {"q": np.sin(3.0 * t)[:, None]})


def test_samples_on_a_grid_stay_as_they_are():
    t = 7.0 + 2e-3 * np.arange(500)
    grid = grid_of(t, None)
    laid, counted = grid.lay(rows(t), slice(100, 400))
    assert grid.as_measured
    assert counted == slice(100, 400)
    assert np.array_equal(laid.columns["q"], rows(t).columns["q"])
    assert np.allclose(laid.t, t - 7.0)
    assert grid_of(t, 500.0).as_measured


@given(st.integers(150, 850), st.integers(0, 99), st.sampled_from([300.0, 777.0, 2100.0]))
def test_neighbours_count_every_instant_once(cut, seed, rate_hz):
    t = 1e-3 * (np.arange(1000) + np.random.default_rng(seed).uniform(-0.3, 0.3, 1000))
    grid = grid_of(t, rate_hz)
    left, counts_left = grid.lay(rows(t[: cut + 100]), slice(0, cut))
    right, counts_right = grid.lay(rows(t[cut - 100 :]), slice(100, len(t) - cut + 100))
    values = np.concatenate([left.columns["q"][counts_left], right.columns["q"][counts_right]])[:, 0]
    instants = t[0] + np.arange(len(values)) / rate_hz
    assert len(values) == int((t[-1] - t[0]) * rate_hz + 1e-6) + 1
    inside = slice(60, -60)
    assert np.allclose(values[inside], np.sin(3.0 * instants[inside]), atol=1e-5)


def test_rows_suffice_for_the_samples_asked_for():
    t = 1e-3 * np.arange(1000)
    for rate_hz in (None, 300.0, 2100.0):
        grid = grid_of(t, rate_hz)
        assert grid.rows(50) * 1e-3 >= 50 * grid.step_s
        assert grid.rows(50) < 1000  # and are no more than a few
        assert grid.rows(51) >= grid.rows(50)


def test_another_rate_or_uneven_stamps_are_no_grid_of_their_own():
    t = 1e-3 * np.arange(1000)
    uneven = t + 1e-4 * np.random.default_rng(0).normal(size=1000)
    assert grid_of(t, None).as_measured and grid_of(t, 1000.0).as_measured
    assert not grid_of(t, 300.0).as_measured and not grid_of(uneven, None).as_measured
    assert grid_of(t, 300.0).step_s == 1.0 / 300.0


def test_stamps_that_leave_the_grid_are_said():
    grid = grid_of(1e-3 * np.arange(100), None)
    with pytest.raises(DataError, match="in rows 1 to 50 stamps are off"):
        grid.lay(rows(1.1e-3 * np.arange(50)), slice(0, 50))
