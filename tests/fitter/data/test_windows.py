"""Overlapping windows: they tile what counts, and a filter sees no edge of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import butter

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


@pytest.mark.parametrize(
    ("n", "portions"), [(40, [40]), (60, [60]), (61, [40, 21]), (100, [40, 60]), (101, [40, 40, 21])]
)
def test_the_last_window_takes_what_is_no_more_than_a_margin(n, portions):
    found = list(windows(slice(0, n + 5), slice(5, n + 5), 40, 20))
    assert [w.last - w.first for w in found] == portions


@pytest.mark.parametrize(("corner_hz", "looked"), [(0.9, True), (224.9, True), (225.0, False), (np.inf, False)])
def test_a_filter_is_forgotten_when_its_slowest_pole_is(corner_hz, looked):
    """A corner from 0.45 of the sampling rate on filters nothing."""
    n = forgetting_samples(2e-3, corner_hz)
    assert (n > 0) == looked
    if looked:
        slowest = np.abs(butter(4, corner_hz, fs=500.0, output="zpk")[1]).max()
        assert slowest**n <= 1e-14 < slowest ** (n - 1)
