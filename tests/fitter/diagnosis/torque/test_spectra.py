"""Coefficients keep sums of squares, and white noise has its variance in each."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fitter.diagnosis.torque.spectra import Spectra


@given(st.integers(120, 400), st.integers(1, 3), st.integers(0, 1000))
def test_coefficients_go_back_to_a_series_of_the_same_squares(n, joints, seed):
    spectra = Spectra(n, 0.01, 20.0)
    rows = np.random.default_rng(seed).normal(size=(n, joints, 2))
    found = spectra.of(rows)
    series = spectra.in_time(found)
    assert series.shape == (spectra.size, joints, 2)
    squares = np.sum(found[0].real ** 2) + np.sum(np.abs(found[1:]) ** 2)
    np.testing.assert_allclose(np.sum(series**2), squares, rtol=1e-9)


def test_white_noise_has_its_variance_in_real_and_imaginary_part():
    spectra = Spectra(2000, 0.002, 100.0)
    noise = 0.3 * np.random.default_rng(1).normal(size=(2000, 1, 40))
    found = spectra.of(noise)[1:]
    expected = 0.09 * np.mean(spectra.weight**2) * 2000 / spectra.size
    np.testing.assert_allclose(np.mean(found.real**2), expected, rtol=0.05)
    np.testing.assert_allclose(np.mean(found.imag**2), expected, rtol=0.05)
