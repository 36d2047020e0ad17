"""Filters and derivatives: accuracy, zero phase, ends."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.signal import butter, sosfiltfilt

from fitter.data.derivatives import both_derivatives, differentiate, lowpass, settling_samples

DT_S = 0.002
T = DT_S * np.arange(2000)


@st.composite
def swings(draw):
    """Make sums of sines up to 12 Hz: value, first and second derivative at some times."""
    n = draw(st.integers(1, 4))
    amplitude = np.array(draw(st.lists(st.floats(0.1, 2.0), min_size=n, max_size=n)))
    omega = 2 * np.pi * np.array(draw(st.lists(st.floats(0.1, 12.0), min_size=n, max_size=n)))
    phase = np.array(draw(st.lists(st.floats(0.0, 6.3), min_size=n, max_size=n)))

    def at(t, order):
        return (amplitude * omega**order * np.sin(np.multiply.outer(t, omega) + phase + order * np.pi / 2)).sum(-1)

    return at, float(omega.max()), float(amplitude.sum())


@given(swings(), st.sampled_from([1, 2]))
def test_derivatives_of_band_limited_motion_are_exact(swing, order):
    at, omega, amplitude = swing
    found = differentiate(at(T, 0)[:, None], DT_S, order)[:, 0]
    scale = amplitude * omega**order
    assert np.abs(found - at(T, order))[10:-10].max() < 2e-5 * scale
    assert np.abs(found - at(T, order)).max() < 5e-3 * scale


@given(swings())
def test_a_filter_far_above_the_motion_changes_neither_size_nor_phase(swing):
    at, _, amplitude = swing
    filtered = lowpass(at(T, 0), DT_S, 60.0)
    trim = settling_samples(DT_S, 60.0)
    assert np.abs(filtered - at(T, 0))[trim:-trim].max() < 1e-3 * amplitude


@given(st.floats(1.0, 30.0), st.floats(0.3, 2.5), st.floats(0.0, 6.3))
def test_gain_is_that_of_the_filter_and_phase_is_zero(cutoff_hz, ratio, phase):
    t = DT_S * np.arange(8000)
    sine = np.sin(2 * np.pi * ratio * cutoff_hz * t + phase)
    inner = slice(3000, 5000)
    basis = np.column_stack([sine, np.cos(2 * np.pi * ratio * cutoff_hz * t + phase)])
    in_phase, out_of_phase = np.linalg.lstsq(basis[inner], lowpass(sine, DT_S, cutoff_hz)[inner])[0]
    warped = np.tan(np.pi * ratio * cutoff_hz * DT_S) / np.tan(np.pi * cutoff_hz * DT_S)
    assert np.isclose(in_phase, 1 / (1 + warped**8), atol=2e-3)
    assert abs(out_of_phase) < 2e-3


@given(arrays.arrays(np.float64, 300, elements=st.floats(-10, 10)), st.floats(2.0, 100.0))
def test_time_turned_round_gives_the_same_turned_round(values, cutoff_hz):
    forth = lowpass(values, DT_S, cutoff_hz)
    back = lowpass(values[::-1], DT_S, cutoff_hz)[::-1]
    trim = min(settling_samples(DT_S, cutoff_hz), 100)
    assert np.allclose(forth[trim:-trim], back[trim:-trim], atol=0.2 if trim == 100 else 0.03)


@settings(max_examples=20)
@given(st.floats(3.0, 20.0))
def test_what_lies_beyond_the_ends_is_forgotten_after_the_settling_time(cutoff_hz):
    """The same motion, once cut off and once going on: after the settling time both look alike."""
    rng = np.random.default_rng(1)
    whole = lowpass(rng.normal(size=6000).cumsum() * 0.01, DT_S, cutoff_hz)
    cut = slice(2000, 4000)
    trim = settling_samples(DT_S, cutoff_hz)
    difference = lowpass(whole[cut], DT_S, cutoff_hz) - lowpass(whole, DT_S, cutoff_hz)[cut]
    assert np.abs(difference[trim:-trim]).max() < 0.02 * whole[cut].std()


def test_a_constant_and_a_slope_pass_unchanged():
    line = np.column_stack([np.full(500, 3.0), np.linspace(-1, 4, 500)])
    assert np.allclose(lowpass(line, DT_S, 5.0), line, atol=1e-6)


def test_columns_of_any_shape_are_filtered_alike():
    values = np.random.default_rng(0).normal(size=(400, 2, 3))
    assert np.allclose(lowpass(values, DT_S, 5.0)[:, 1, 2], lowpass(values[:, 1, 2], DT_S, 5.0))


@pytest.mark.parametrize("cutoff_hz", [np.inf, 500.0, 240.0])
def test_a_corner_beyond_the_range_does_nothing(cutoff_hz):
    values = np.random.default_rng(0).normal(size=100)
    assert lowpass(values, DT_S, cutoff_hz) is values
    assert settling_samples(DT_S, cutoff_hz) == 0


def test_both_derivatives_are_those_that_are_asked_for_one_by_one():
    values = np.random.default_rng(0).normal(size=(40, 2))
    for order, found in enumerate(both_derivatives(values, DT_S), start=1):
        np.testing.assert_array_equal(found, differentiate(values, DT_S, order))


@pytest.mark.parametrize("ends", ["odd", "even"])
@pytest.mark.parametrize("shape", [(400,), (400, 2), (400, 2, 3), (12,)])
def test_the_low_pass_is_scipys(ends, shape):
    """Only that the filter's settled state is not worked out again each time."""
    values = np.random.default_rng(0).normal(size=shape)
    sections = butter(4, 20.0, fs=1.0 / DT_S, output="sos")
    padding = min(len(values) - 1, 3 * settling_samples(DT_S, 20.0))
    whole = sosfiltfilt(sections, values, axis=0, padtype=ends, padlen=padding)
    np.testing.assert_allclose(lowpass(values, DT_S, 20.0, ends), whole, atol=1e-12)


@pytest.mark.parametrize(
    ("cutoff_hz", "samples"), [(5.0, 204), (224.0, 9), (225.0, 0), (250.0, 0), (np.inf, 0), (0.5, 2004)]
)
def test_ends_settle_within_two_periods_and_the_filter_s_order(cutoff_hz, samples):
    """From 0.45 of the sampling rate on nothing is filtered."""
    assert settling_samples(DT_S, cutoff_hz) == samples
    values = np.random.default_rng(0).normal(size=100)
    assert (lowpass(values, DT_S, cutoff_hz) is values) == (samples == 0)


def test_the_first_derivative_is_that_of_a_quintic():
    t = 0.5 * np.arange(9)
    quintic = np.column_stack([t**5 - t, 3.0 * t])
    np.testing.assert_allclose(
        differentiate(quintic, 0.5), np.column_stack([5 * t**4 - 1, 3.0 + 0 * t]), atol=1e-9
    )
    np.testing.assert_allclose(differentiate(quintic, 0.5, 2), np.column_stack([20 * t**3, 0 * t]), atol=1e-9)


def test_a_column_goes_on_turned_about_its_last_point_unless_mirrored():
    line = np.linspace(0.0, 1.0, 60)
    np.testing.assert_allclose(lowpass(line, DT_S, 60.0), lowpass(line, DT_S, 60.0, "odd"), rtol=0, atol=0)
    assert abs(lowpass(line, DT_S, 60.0)[-1] - 1.0) < 1e-6 < 1.0 - lowpass(line, DT_S, 60.0, "even")[-1]
