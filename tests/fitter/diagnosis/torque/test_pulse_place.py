"""The likeliest place of a pulse: between rows, from a place beside it, and past a trial's ends."""

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Background
from fitter.diagnosis.torque.pulse_column import in_rows
from fitter.diagnosis.torque.pulse_place import likeliest_place
from fitter.diagnosis.torque.student_ratio import likeliest_ratio
from tests.fitter.diagnosis.torque.residuals import trial

MODEL = Background(0.05, 0.3, 1e-6, 20.0, 0.5, np.full(2, 1e-9), np.ones(2), 1e-6, 1e-9, 30.0, 1e-9)


@pytest.mark.parametrize("form", ["rectangular", "bell"])
def test_the_place_is_likelier_than_all_beside_it(form):
    rows = trial(np.random.default_rng(4), [(2.04, 0.23, 3.0, form)]).rows(0)
    kalman, nu = MODEL.filtered(rows), MODEL.degrees_of_freedom
    start_s, duration_s, size = likeliest_place(rows, kalman, nu, rows.r, (2.0, 0.2), form)
    assert (start_s, duration_s) == pytest.approx((2.04, 0.23), abs=0.02)
    assert size == pytest.approx(3.0, rel=0.1)
    e = kalman.innovations(rows.r)

    def ratio(*place):
        return likeliest_ratio(e, kalman.innovations(in_rows(rows, *place, form)), nu)[0]

    best = ratio(start_s, duration_s)
    for step_s in (-0.01, 0.01):
        assert ratio(start_s + step_s, duration_s) < best + 0.01
        assert ratio(start_s, duration_s + step_s) < best + 0.01


def test_a_place_that_no_sample_of_the_trial_shows_has_no_size():
    """A search from a trial's end on tries such places, and warned of a mean of nothing."""
    rows = trial(np.random.default_rng(4)).rows(0)
    nothing = np.zeros(len(rows.t))
    _, _, size = likeliest_place(rows, MODEL.filtered(rows), 30.0, nothing, (60.0, 0.2), "rectangular")
    assert size == 0.0
