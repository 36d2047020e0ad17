"""One trial."""

from dataclasses import replace

import numpy as np

from fitter.data.derivatives import lowpass
from fitter.data.trial import undriven
from tests.fitter.data.random_columns import DT_S, Q


def test_an_arm_that_swings_freely_has_no_torque_and_no_target(full):
    free = undriven(full)
    assert not free.tau.any() and free.tau.shape == Q.shape and not free.tau_measured.any()
    assert free.ref is free.ref_filtered is free.drives is None
    assert set(free.whole) == {"q", "tau"} and not free.whole["tau"].any()
    assert undriven(replace(full, whole={})).whole == {}


def test_the_filter_of_a_fit_mirrors_its_ends(full):
    np.testing.assert_array_equal(full.lowpass(Q), Q)
    narrow = replace(full, band_hz=5.0)
    np.testing.assert_array_equal(narrow.lowpass(Q), lowpass(Q, DT_S, 5.0, ends="even"))


def test_what_has_dead_reckoned_points_was_tracked(full):
    assert full.tracked and not replace(full, points=None).tracked
