"""Where a search begins: where it has come to before, and where the residual swings most."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.least_squares import N_REFINED
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import Starts, peaks
from tests.fitter.diagnosis.linear import Columns

BAND_HZ, DT_S, STRIDE = 10.0, 0.01, 4


@given(st.floats(0.5, 9.0), st.floats(0.0, 6.0))
@settings(max_examples=20, deadline=None)
def test_the_first_is_the_frequency_that_swings_most(frequency_hz, phase):
    motions = [SimpleNamespace(t=start + np.arange(500) * DT_S, dt_s=DT_S) for start in (0.0, 5.0, 10.0)]
    t = np.concatenate([motion.t[::STRIDE] for motion in motions])
    left = np.sin(2.0 * np.pi * frequency_hz * t + phase) + 0.1 * np.random.default_rng(0).normal(size=len(t))
    found = peaks(left, motions, SimpleNamespace(stride=STRIDE, band_hz=BAND_HZ))
    assert found.shape == (N_REFINED, 1)
    assert found[0, 0] == pytest.approx(frequency_hz, abs=0.02)
    assert np.diff(np.sort(found[:, 0])).min() > 1.0 / 15.0


def test_what_was_sought_beside_the_same_is_found_again_whatever_the_order():
    one, other, sought = Columns(0), Columns(1), Columns(2)
    starts = Starts()
    ahead, back = (Model((a, b), (np.zeros(0),) * 2) for a, b in ((one, other), (other, one)))
    starts.keep(ahead, sought, np.array([[3.0]]))
    np.testing.assert_array_equal(starts.of(back, sought), [[3.0]])
    assert starts.of(Model(), sought) is None and starts.of(ahead, one) is None
