"""A pulse as the rows of a residual see it: its form, its area, and the filter of its samples."""

import numpy as np
import pytest

from fitter.data.derivatives import lowpass
from fitter.diagnosis.torque.pulse_column import in_rows, pulse_means, seen
from tests.fitter.diagnosis.torque.residuals import trial


@pytest.mark.parametrize("form", ["rectangular", "bell"])
def test_a_pulse_is_at_half_its_size_at_its_ends(form):
    t = np.arange(0.0, 2.0, 1e-3)
    shape = pulse_means(t, 1e-3, 0.7, 0.4, form)
    above = t[shape > 0.5]
    assert (above[0], above[-1]) == pytest.approx((0.7, 1.1), abs=2e-3)
    assert shape.max() == pytest.approx(1.0, abs=1e-4)
    assert shape.sum() * 1e-3 == pytest.approx(0.4)


@pytest.mark.parametrize("form", ["rectangular", "bell"])
def test_the_filter_keeps_the_area_of_a_pulse_in_the_rows(form):
    rows = trial(np.random.default_rng(8)).rows(0)
    column = in_rows(rows, 4.0, 0.6, form)
    assert column.shape == rows.t.shape
    assert column.sum() * rows.step_s == pytest.approx(0.6, rel=0.01)
    assert np.max(np.abs(column[rows.t < 3.0])) == 0.0


@pytest.mark.parametrize("form", ["rectangular", "bell"])
@pytest.mark.parametrize(("start_s", "duration_s"), [(4.0, 0.6), (4.013, 0.031), (-0.1, 0.4), (9.8, 0.5)])
def test_rows_are_means_of_the_filtered_samples(form, start_s, duration_s):
    """Against the filter itself; of a pulse that goes on past the trial's ends the samples inside count."""
    rows = trial(np.random.default_rng(8)).rows(0)
    step_s, beyond = rows.step_s / rows.n_sample, 400 * rows.n_sample
    t = rows.t[0] - 0.5 * rows.step_s + step_s * (np.arange(-beyond, len(rows.t) * rows.n_sample + beyond) + 0.5)
    samples = pulse_means(t, step_s, start_s, duration_s, form)
    samples[:beyond] = samples[-beyond:] = 0.0
    means = lowpass(samples, step_s, rows.band_hz)[beyond:-beyond].reshape(-1, rows.n_sample).mean(axis=1)
    first, part = seen(rows, start_s, duration_s, form)
    assert part == pytest.approx(means[first : first + len(part)], abs=0.002)
    column = in_rows(rows, start_s, duration_s, form)
    assert np.count_nonzero(column[:first]) == np.count_nonzero(column[first + len(part) :]) == 0


def test_a_pulse_past_the_trials_ends_touches_no_row():
    rows = trial(np.random.default_rng(8)).rows(0)
    for start_s in (-60.0, 60.0):
        assert len(seen(rows, start_s, 0.2, "bell")[1]) == 0
