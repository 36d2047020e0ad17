"""Times of samples in blocks rise, and follow the stamps where these wait."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fitter.data.block_times import block_times

STEP_S = 1e-3


def test_where_stamps_go_on_by_the_step_samples_do():
    t = block_times([5, 8], [3, 2], [0, 3_000_000], [STEP_S, STEP_S])
    np.testing.assert_allclose(t, 1e6 * np.arange(5))


def test_a_block_that_begins_before_the_last_one_would_end_draws_it_together():
    t = block_times([0, 4], [4, 2], [0, 2_000_000], [STEP_S, STEP_S])
    np.testing.assert_allclose(t, [0.0, 0.5e6, 1e6, 1.5e6, 2e6, 3e6])


def test_where_samples_are_missing_nothing_is_drawn_together():
    t = block_times([0, 9], [4, 2], [0, 9_000_000], [STEP_S, STEP_S])
    np.testing.assert_allclose(t, [0.0, 1e6, 2e6, 3e6, 9e6, 10e6])


@given(st.lists(st.tuples(st.integers(1, 20), st.floats(0.5, 1.2)), min_size=2, max_size=20))
def test_times_rise_where_stamps_do(blocks):
    """A stamp goes on by half of the step at the least, as the daemon's do."""
    counts = [n for n, _ in blocks]
    stamps = np.cumsum([0, *(round(1e6 * n * rate) for n, rate in blocks[:-1])]).tolist()
    first = np.cumsum([0, *counts[:-1]]).tolist()
    t = block_times(first, counts, stamps, [STEP_S] * len(blocks))
    assert np.all(np.diff(t) > 0.0)
    np.testing.assert_array_equal(t[first], stamps)


def test_of_no_block_there_are_no_times():
    assert len(block_times([], [], [], [])) == 0
