"""The filter of trials."""

import numpy as np
import pytest

from fitter.data.derivatives import lowpass
from fitter.data.trial import Trial
from fitter.data.trial_filter import choose_cutoff_hz, lowpass_trial, trimmed_samples
from tests.fitter.data.random_columns import CLOCK, DDQ, DQ, DT_S, N, Q, uniform


def test_lowpass_trial_trims_what_it_filters_and_what_it_does_not(full):
    found, inner = lowpass_trial(full, 20.0), slice(54, N - 54)
    for name in ("q", "dq", "ddq", "tau", "ref", "ref_filtered", "tip", "points"):
        np.testing.assert_array_equal(getattr(found, name), lowpass(getattr(full, name), DT_S, 20.0)[inner])
    for name in ("tau_measured", "contradicted"):
        np.testing.assert_array_equal(getattr(found, name), getattr(full, name)[inner])
    np.testing.assert_array_equal(found.drives.kv, DQ[inner])
    np.testing.assert_array_equal(found.t, CLOCK[: N - 108])
    assert (found.trimmed, found.began_s) == (59, pytest.approx(3.0 + 54 * DT_S))
    assert found.cutoff_hz == found.band_hz == np.inf
    assert found.notes[-1].text == "all columns low-passed at 20 Hz (zero phase)"
    bare = lowpass_trial(Trial("run", CLOCK, DT_S, Q, DQ, DDQ), 20.0)
    for name in ("tau", "ref", "ref_filtered", "tip", "points", "tau_measured", "contradicted", "drives"):
        assert getattr(bare, name) is None


@pytest.mark.parametrize(("n", "trimmed"), [(1000, 54), (500, 50), (100, 10)])
def test_no_more_than_a_tenth_is_trimmed_at_either_end(n, trimmed):
    assert trimmed_samples(n, DT_S, 20.0) == trimmed


def test_the_corner_is_above_the_edge_of_the_motion_and_below_the_noise_s():
    swing = np.sin(2.0 * np.pi * 2.0 * CLOCK)[:, None] * [1.0, 0.5]
    noise = 1e-4 * np.random.default_rng(1).normal(size=(N, 2))
    assert 2.0 < choose_cutoff_hz([uniform(q=swing + noise)]) < 50.0
