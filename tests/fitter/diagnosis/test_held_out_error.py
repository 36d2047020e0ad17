"""Errors of models on some trials."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Control, Floats
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.held_out import judged, unfiltered
from fitter.diagnosis.held_out_error import Errors
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings


def errors(angle_square=(0.04, 0.0), raw=((4.0,), (0.0,))) -> Errors:
    square, count = np.array([[1.0], [3.0]]), np.array([[2.0], [2.0]])
    sums, size = np.array([0.2, 0.0]), np.array([2.0, 2.0])
    return Errors(
        square,
        count,
        None if raw is None else np.array(raw),
        np.array(angle_square),
        sums,
        np.array([0.2, 0.0]),
        size,
        [np.zeros((2, 1))] * 2,
    )


def test_errors_of_all_trials_and_of_some():
    document = errors().document()
    assert document["torque_rms_N_m"] == [1.0] and document["torque_rms_unfiltered_N_m"] == [1.0]
    assert document["angle_error_deg"] == pytest.approx(
        {"mean": np.rad2deg(0.05), "rms": np.rad2deg(0.1), "max": np.rad2deg(0.2)}
    )
    second = errors().only([1])
    assert second.torque_rms[0] == pytest.approx(np.sqrt(1.5)) and second.angle_max_deg == 0.0
    assert len(second.simulated) == 1


def test_what_ran_away_or_was_not_measured_is_null():
    document = errors((np.inf, 0.0), None).document()
    assert document["torque_rms_unfiltered_N_m"] is None and document["angle_error_deg"]["rms"] is None


def test_the_noise_of_a_measured_torque_counts_in_the_unfiltered_error_alone():
    arm = pendulum()
    trials = to_trials(swings((), trials=3, seed=3), cutoff_hz=25.0)
    plain = regression_of(arm, run_of(arm, trials[:2], trials[2:]))
    fitted = Candidate(Model(), plain.solve(Model(), plain.learning), np.zeros(3))
    given, (driven,) = replace(arm, control=Control("measured")), run_of(arm, [], trials[2:], thin=False)
    noise = 5.0 * np.random.default_rng(0).normal(size=driven.u.shape)

    def found(measured: Floats) -> Errors:
        trial = replace(driven.trial, tau=driven.u, tau_measured=measured, ref=None)
        return judged(plain, fitted, given, [replace(driven, trial=trial)])

    clean, noisy = found(driven.u), found(driven.u + noise)
    assert clean.unfiltered_rms is not None and noisy.unfiltered_rms is not None
    assert noisy.torque_rms == clean.torque_rms < clean.unfiltered_rms
    assert noisy.unfiltered_rms[0] == pytest.approx(np.hypot(clean.unfiltered_rms[0], 5.0), rel=0.05)
    assert judged(plain, fitted, arm, [driven]).unfiltered_rms is None


def test_without_a_measured_torque_nothing_is_unfiltered():
    (trial,) = to_trials(swings((), trials=1), cutoff_hz=25.0)
    (motion,) = run_of(pendulum(), [], [trial], thin=False)
    assert unfiltered(np.zeros_like(motion.u), motion) is None
