"""Errors of models on some trials."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Control, Floats
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.held_out import judged, unfiltered
from fitter.diagnosis.held_out_error import Errors, gain
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings


def errors(motion_square=(0.04, 0.0), raw=((4.0,), (0.0,)), turns=True) -> Errors:
    square, count = np.array([[1.0], [1.0], [2.0]]), np.array([[2.0], [1.0], [1.0]])
    sums, size = np.array([[0.2], [0.0]]), np.array([[2.0], [2.0]])
    return Errors(
        square,
        count,
        np.array([0, 1, 1]),
        None if raw is None else np.array(raw),
        np.array(motion_square)[:, None],
        sums,
        np.array([[0.2], [0.0]]),
        size,
        np.array([turns]),
        [np.zeros((2, 1))] * 2,
    )


def of_blocks(squares, trial) -> Errors:
    """Return errors of torque alone, in blocks of some trials."""
    n, nothing = len(squares), np.zeros((max(trial) + 1, 1))
    square = np.array(squares, dtype=np.float64)[:, None]
    rest = nothing, nothing, nothing, nothing, np.array([True]), []
    return Errors(square, np.ones((n, 1)), np.array(trial), None, *rest)


def test_errors_of_all_trials_and_of_some():
    document = errors().document()
    assert document["torque_rms_N_m"] == [1.0] and document["torque_rms_unfiltered_N_m"] == [1.0]
    assert document["angle_error_deg"] == pytest.approx(
        {"mean": np.rad2deg(0.05), "rms": np.rad2deg(0.1), "max": np.rad2deg(0.2)}
    )
    second = errors().only([1])
    assert second.torque_rms[0] == pytest.approx(np.sqrt(1.5)) and second.angle_deg["max"] == 0.0
    assert len(second.simulated) == 1 and second.block_trial.tolist() == [0, 0]


def test_joints_that_slide_have_errors_in_metres():
    document = errors(turns=False).document()
    assert document["angle_error_deg"] is None
    assert document["position_error_m"] == pytest.approx({"mean": 0.05, "rms": 0.1, "max": 0.2})
    assert errors().document()["position_error_m"] is None
    fell = gain(errors(turns=False), errors((0.01, 0.0), turns=False))
    assert fell.position == pytest.approx(0.5) and np.isnan(fell.angle)


def test_the_gain_of_one_trial_has_the_scatter_of_its_blocks():
    """As errors halve on average, the standard error of the mean of squares says how far the gain may be off."""
    rng, n = np.random.default_rng(2), 40
    was, became = np.ones(n), 0.25 * rng.uniform(0.5, 1.5, n)
    found = gain(of_blocks(was, [0] * n), of_blocks(became, [0] * n))
    half = 1.96 * np.std(became) / np.sqrt(n) / (2.0 * np.sqrt(became.mean()))
    assert found.ci95 is not None
    assert np.diff(found.ci95) == pytest.approx([2.0 * half], rel=0.15)
    assert found.ci95[0] < found.torque < found.ci95[1]


def test_trials_that_differ_widen_the_interval():
    became, trial = np.repeat([0.1, 0.4, 0.1, 0.4], 10), np.repeat(range(4), 10)
    alike, apart = (gain(of_blocks(np.ones(40), k), of_blocks(became, k)) for k in (trial[::-1] * 0, trial))
    assert np.diff(apart.ci95) > 2.0 * np.diff(alike.ci95)


def test_a_few_seconds_have_no_interval():
    found = gain(of_blocks(np.ones(3), [0] * 3), of_blocks(np.full(3, 0.5), [0] * 3))
    assert found.ci95 is None and found.document()["ci95"] is None


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
