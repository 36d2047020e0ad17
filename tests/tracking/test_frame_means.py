"""Readings averaged to frames: whatever way they come, lost ones are not made up."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tracking.frame_means import FrameMeans


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
