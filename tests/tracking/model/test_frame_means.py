"""Readings averaged to frames: whatever way they come, lost ones are not made up."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracking.model.frame_means import FrameMeans
from tracking.model.noise import noise_of


@given(st.lists(st.integers(1, 40), min_size=1, max_size=8), st.integers(1, 7))
def test_the_means_do_not_depend_on_how_blocks_are_cut(sizes, factor):
    readings = np.arange(2.0 * sum(sizes)).reshape(-1, 2)
    means = FrameMeans(factor, 2, 1000.0)
    for begin, end in zip(np.cumsum([0, *sizes[:-1]]), np.cumsum(sizes), strict=True):
        means.push(readings[begin:end])
    n = len(readings) // factor
    expected = readings[: n * factor].reshape(n, factor, 2).mean(axis=1)
    np.testing.assert_allclose(means.means(0, n), expected)


def test_what_was_lost_is_not_a_number():
    means = FrameMeans(4, 1, 1000.0)
    means.push(np.ones((8, 1)))
    means.skip_to(16)
    means.push(np.ones((8, 1)))
    found = means.means(2, 4)
    assert np.isnan(found[:2]).all() and (found[2:] == 1.0).all()


def test_the_noise_is_known_after_a_quarter_of_a_second():
    means, rng = FrameMeans(4, 3, 1000.0), np.random.default_rng(0)
    means.push(rng.normal(0.0, 0.02, (200, 3)))
    assert means.noise is None
    means.push(rng.normal(0.0, 0.02, (100, 3)))
    white, rounding = means.noise
    np.testing.assert_allclose(white, 0.02**2 / 4, rtol=0.5)
    assert (rounding < 1e-9).all()


@pytest.mark.parametrize(("rate_hz", "needed"), [(1000.0, 250), (100.0, 25), (20.0, 8), (1.0, 8)])
def test_a_quarter_of_a_second_is_eight_readings_at_least(rate_hz, needed):
    means, readings = FrameMeans(2, 1, rate_hz), np.random.default_rng(0).normal(size=(needed, 1))
    means.push(readings[:-1])
    assert means.noise is None
    means.push(readings[-1:])
    np.testing.assert_array_equal(means.noise, noise_of(readings, rate_hz).parts_of_mean(2))
    before = means.noise
    means.push(100.0 * readings)  # what comes later changes nothing
    assert means.noise is before


def test_a_frame_of_which_some_was_lost_is_the_mean_of_the_rest():
    means = FrameMeans(4, 1, 1000.0)
    means.skip_to(2)
    means.push(np.array([[1.0], [3.0], [5.0]]))
    found = means.means(0, 3)[:, 0]
    assert found[:2].tolist() == [2.0, 5.0] and np.isnan(found[2])
    means.skip_to(12)
    means.push(np.full((4, 1), 4.0))
    assert means.means(3, 1)[0, 0] == 4.0
