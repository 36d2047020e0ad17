"""A pulse as the rows of a residual see it, and how well its ends and its form are known."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.pulse import Pulse, either, in_rows, pulse_means
from tests.fitter.diagnosis.torque.residuals import trial


@pytest.mark.parametrize("form", ["rectangular", "bell"])
def test_a_pulse_is_at_half_its_size_at_its_ends(form):
    t = np.arange(0.0, 2.0, 1e-3)
    shape = pulse_means(t, 1e-3, 0.7, 0.4, form)
    above = t[shape > 0.5]
    assert (above[0], above[-1]) == pytest.approx((0.7, 1.1), abs=2e-3)
    assert shape.max() == pytest.approx(1.0, abs=1e-4)
    assert shape.sum() * 1e-3 == pytest.approx(0.4)


PULSE = Pulse(0, 0, 1.0, 0.2, 5.0, 0.01, 0.02, 0.3, 0.1, "rectangular", 20.0, 15.0)


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ({"start_s": 1.19}, True),
        ({"start_s": 0.85, "duration_s": 0.16}, True),
        ({"start_s": 1.2}, False),
        ({"start_s": 0.8}, False),
        ({"trial": 1}, False),
        ({"joint": 1}, False),
        ({"torque_N_m": -5.0}, False),
    ],
)
def test_pulses_overlap_at_one_joint_at_one_time_in_one_direction(other, expected):
    other = replace(PULSE, **other)
    assert PULSE.overlaps(other) is other.overlaps(PULSE) is expected


def test_a_form_that_might_be_another_has_the_error_of_both():
    bell = Pulse(0, 0, 1.0, 0.2, 0.6, 0.01, 0.01, 0.03, 0.005, "bell", 20.0, 15.0)
    for less, error in ((0.0, np.hypot(0.03, 0.1 / np.sqrt(2.0))), (30.0, 0.03)):
        other = replace(bell, form="rectangular", torque_N_m=0.5, log_likelihood_ratio=20.0 - less)
        one = either([other, bell])
        assert one.torque_std == pytest.approx(error, rel=1e-3)


@pytest.mark.parametrize("form", ["rectangular", "bell"])
def test_the_filter_keeps_the_area_of_a_pulse_in_the_rows(form):
    rows = trial(np.random.default_rng(8)).rows(0)
    column = in_rows(rows, 4.0, 0.6, form)
    assert column.shape == rows.t.shape
    assert column.sum() * rows.step_s == pytest.approx(0.6, rel=0.01)
    assert np.max(np.abs(column[rows.t < 3.0])) == 0.0
