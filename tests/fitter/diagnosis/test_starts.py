"""A swing that goes on over all trials is found at its frequency."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.starts import peaks

BAND_HZ, DT_S, STRIDE = 10.0, 0.01, 4


@given(st.floats(0.5, 9.0), st.floats(0.0, 6.0))
@settings(max_examples=20, deadline=None)
def test_the_first_is_the_frequency_that_swings_most(frequency_hz, phase):
    motions = [SimpleNamespace(t=start + np.arange(500) * DT_S, dt_s=DT_S) for start in (0.0, 5.0, 10.0)]
    t = np.concatenate([motion.t[::STRIDE] for motion in motions])
    left = np.sin(2.0 * np.pi * frequency_hz * t + phase) + 0.1 * np.random.default_rng(0).normal(size=len(t))
    found = peaks(left, motions, SimpleNamespace(stride=STRIDE, band_hz=BAND_HZ))
    assert found.shape == (4, 1)
    assert found[0, 0] == pytest.approx(frequency_hz, abs=0.02)
    assert np.diff(np.sort(found[:, 0])).min() > 1.0 / 15.0
