"""Velocities behind filters, and the noise that these leave."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from fitter.diagnosis.velocity import sharper, sharper_gain


@pytest.mark.parametrize("dt_s", [0.0005, 0.002, 0.01])
def test_the_noise_of_a_velocity_is_what_its_filters_leave(dt_s: float) -> None:
    rng = np.random.default_rng(0)
    width = max(0.006, 1.5 * dt_s) / dt_s
    angle = 1e-4 * rng.normal(size=(200_000, 1))
    slopes = gaussian_filter1d(angle, width, axis=0, order=1) / dt_s
    assert np.std(sharper(slopes, dt_s)) == pytest.approx(1e-4 * sharper_gain(dt_s), rel=0.03)
