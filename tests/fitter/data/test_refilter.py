"""Trials filtered less."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.motions import Measured
from fitter.data.plausibility.saturated import CONTRADICTED
from fitter.data.refilter import refiltered
from fitter.data.trials import to_trials


def test_a_trial_that_was_never_filtered_stays_as_it_is(bench_trials):
    assert refiltered(bench_trials[:1])[0] is bench_trials[0]


def test_twice_the_corner_brings_derivatives_nearer_to_the_truth(bench_trials):
    true = bench_trials[0]
    measured = Measured("m", "m", 0, true.t, {"q": true.q, "ref": true.ref, "tau": true.tau})
    (narrow,) = to_trials([measured], cutoff_hz=3.0)
    (wide,) = refiltered([narrow])
    assert wide.cutoff_hz == pytest.approx(6.0)
    assert wide.band_hz == pytest.approx(2.0 * narrow.band_hz)
    assert wide.trimmed < narrow.trimmed
    for trial in (narrow, wide):
        assert np.array_equal(trial.whole["q"], true.q)
    inner = slice(narrow.trimmed, len(true.q) - narrow.trimmed)
    within = slice(narrow.trimmed - wide.trimmed, narrow.trimmed - wide.trimmed + len(narrow.q))
    off = [np.abs(ddq - true.ddq[inner]).max() for ddq in (narrow.ddq, wide.ddq[within])]
    assert off[1] < 0.8 * off[0]


def test_it_keeps_measured_velocities_what_is_contradicted_and_its_place_in_the_run(bench_trials):
    true = bench_trials[0]
    dq = true.dq + 0.1  # known to be other than the derivative
    marked = np.zeros_like(true.q)
    marked[600:700, 0] = 1.0
    columns = {"q": true.q, "dq": dq, "tau": true.tau, CONTRADICTED: marked}
    (narrow,) = to_trials([Measured("m", "m", 0, 7.0 + true.t, columns)], cutoff_hz=3.0)
    narrow = replace(narrow, role="learn", number=3)
    (wide,) = refiltered([narrow])
    inner = slice(wide.trimmed, len(true.q) - wide.trimmed)
    assert np.mean(wide.dq - true.dq[inner]) == pytest.approx(0.1, abs=0.01)
    assert np.array_equal(wide.contradicted[:, 0], marked[inner, 0] > 0.0)
    assert (wide.role, wide.number) == ("learn", 3)
    assert wide.began_s == pytest.approx(7.0 + wide.trimmed * wide.dt_s)


def test_a_piece_shorter_than_a_period_of_the_corner_is_refiltered(bench_trials):
    true = bench_trials[0]
    measured = [
        Measured(name, name, 0, true.t[:n], {"q": true.q[:n], "tau": true.tau[:n]})
        for name, n in (("piece", 40), ("rest", len(true.t)))
    ]
    piece, _ = to_trials(measured, cutoff_hz=0.4 / (40 * true.dt_s))
    (wide,) = refiltered([piece])
    assert len(wide.whole["q"]) == 40
    assert wide.cutoff_hz == pytest.approx(0.8 / (40 * true.dt_s))
