"""Torques that nobody knows do not pass for physics."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from fitter.diagnosis.whitening import Whitening, end_weight, holding_shapes, jump_shapes


def test_an_impulse_lies_between_two_samples_and_keeps_its_size():
    shapes = jump_shapes([(3.25, 1, 0.4), (0.0, 0, 1.0)], 8, 2)
    assert shapes.shape == (8, 2, 2)
    assert shapes[3:5, 1, 0] == pytest.approx([0.3, 0.1])
    assert shapes[0, 0, 1] == 1.0
    np.testing.assert_allclose(shapes.sum(axis=(0, 1)), [0.4, 1.0])


def test_no_jump_no_shape():
    assert jump_shapes([], 8, 2).shape == (8, 2, 0)


@pytest.mark.parametrize("first", range(4, 20, 4))
def test_friction_that_jumps_somewhere_in_a_short_rest_is_followed(first):
    """A joint turns round within 40 ms: when, nobody sees, nor where its friction changed sides."""
    dt_s, begin, end = 0.002, 200, 220
    stuck = np.zeros(400, dtype=np.bool_)
    stuck[begin:end] = True
    k = np.arange(400)
    torque = np.where(k < begin + first, -1.0, 1.0) * stuck * end_weight(400, dt_s)
    shapes = holding_shapes(stuck, dt_s)
    slow = gaussian_filter1d(np.column_stack([torque, shapes]), 5.0, axis=0)  # 15 Hz, as the filter's band
    left = slow[:, 0] - slow[:, 1:] @ np.linalg.lstsq(slow[:, 1:], slow[:, 0], rcond=1e-9)[0]
    assert np.linalg.norm(left) < 0.05 * np.linalg.norm(slow[:, 0])


def test_noise_of_the_stated_spectrum_comes_out_white_with_variance_one():
    """By a chi-square of its band-limited numbers, two joints whose noise is correlated."""
    dt_s, band_hz, n, s_u = 0.005, 20.0, 20_000, np.array([0.1, 0.3])
    acceleration = np.array([[2e-9, 1e-9], [1e-9, 3e-9]])
    filt = Whitening(s_u, acceleration, band_hz, 4)
    rng = np.random.default_rng(3)
    f = np.fft.rfftfreq(n, dt_s)
    bends = np.linalg.cholesky(acceleration) @ np.fft.rfft(rng.normal(size=(n, 2)), axis=0)[..., None]
    bent = np.fft.irfft(bends[..., 0] * (2.0 * np.pi * f[:, None]) ** 2, n, axis=0)
    white = filt.white(bent + s_u * rng.normal(size=(n, 2)), dt_s)
    n_effective = filt.n_in_band(len(white), dt_s)
    squares = np.sum(white**2, axis=0)
    assert np.all(np.abs(squares - n_effective) < 4.0 * np.sqrt(2.0 * n_effective))
    assert abs(white[:, 0] @ white[:, 1]) < 4.0 * np.sqrt(n_effective)


def test_a_mean_of_white_noise_is_less_by_the_root_of_its_number():
    filt = Whitening(np.array([0.2]), np.zeros((1, 1)), 20.0, 1)
    assert filt.mean_noise(0, np.full(50, 1.0 / 50), 0.01) == pytest.approx(0.2 / np.sqrt(50.0))


def test_noise_of_angles_is_seen_until_it_outgrows_that_of_the_torque():
    filt = Whitening(np.array([0.1]), np.array([[1e-8]]), 50.0, 1)
    assert filt.covariance(filt.seen_hz)[0, 0] == pytest.approx(2.0 * 0.1**2)
