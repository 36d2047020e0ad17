"""Overlapping windows: they tile what counts, and a filter sees no edge of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.data.derivatives import lowpass
from fitter.data.windows import forgetting_samples, windows


@given(st.integers(0, 40), st.integers(1, 300), st.integers(0, 40), st.integers(1, 60), st.integers(0, 50))
def test_windows_tile_what_counts_and_stay_within_what_is_seen(before, n, after, portion, margin):
    seen, counted = slice(0, before + n + after), slice(before, before + n)
    found = list(windows(seen, counted, portion, margin))
    assert [w.first for w in found] == [counted.start, *(w.last for w in found[:-1])]
    assert found[-1].last == counted.stop
    for w in found:
        assert w.begin == max(0, w.first - margin)
        assert w.end == min(seen.stop, w.last + margin)
        assert np.arange(seen.stop)[w.all][w.counted].tolist() == list(range(w.first, w.last))


@pytest.mark.parametrize("corner_hz", [3.0, 40.0, 200.0, 440.0])
def test_a_filter_forgets_an_edge_within_the_margin(corner_hz):
    rng = np.random.default_rng(0)
    values, margin = rng.normal(size=(20_000, 2)), forgetting_samples(1e-3, corner_hz)
    whole = lowpass(values, 1e-3, corner_hz)
    for w in windows(slice(0, 20_000), slice(0, 20_000), 3000, margin):
        part = lowpass(values[w.all], 1e-3, corner_hz)[w.counted]
        assert np.abs(part - whole[w.first : w.last]).max() < 1e-11 * np.abs(whole).max()


def test_what_is_not_filtered_needs_no_margin():
    assert forgetting_samples(1e-3, np.inf, 499.0) == 0


def test_one_filter_after_the_other_looks_further():
    both = forgetting_samples(1e-3, 10.0, 5.0)
    assert both == forgetting_samples(1e-3, 10.0) + forgetting_samples(1e-3, 5.0)
    assert both == pytest.approx(3 * 13.4 / 10.0 / 1e-3, rel=0.02)  # periods of the corner
