"""Trials reduced to sums."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.model import Control
from arm.regressor import standard_parameters
from fitter.regression_sums.trial_sums import trial_sums
from limbcal.errors import DataError

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
TRUE = BASE.combination @ standard_parameters(ARM)


def test_the_true_parameters_cost_nothing(bench_trials):
    for trial in (bench_trials[0], replace(bench_trials[0], ref=None), replace(bench_trials[0], band_hz=6.0)):
        sums = trial_sums(ARM, BASE, trial)
        assert sums.cost(TRUE[None])[0] < 1e-5 * sums.power.sum()


def test_a_rest_before_an_unknown_target_is_left_out(bench_trials):
    trial = replace(bench_trials[1], ref=None)
    left_out = len(trial.t) - trial_sums(ARM, BASE, trial).samples
    assert left_out * trial.dt_s == pytest.approx(0.5, abs=0.01)


def test_needs_a_torque(bench_trials):
    with pytest.raises(DataError, match="has no torque"):
        trial_sums(replace(ARM, control=Control()), BASE, replace(bench_trials[0], tau=None))


def test_slow_joints_are_left_out(bench_trials):
    trial = bench_trials[2]
    counts = trial_sums(ARM, BASE, trial, rest_speed=0.1).count.sum(axis=0)
    assert counts.tolist() == np.count_nonzero(np.abs(trial.dq) > 0.1, axis=0).tolist()


def test_a_trial_filtered_in_windows_has_the_sums_of_the_whole(bench_trials, monkeypatch):
    trial = replace(bench_trials[0], band_hz=40.0)
    whole = trial_sums(ARM, BASE, trial)
    monkeypatch.setattr("fitter.regression_sums.trial_sums._ROW_BYTES", 1)
    parted = trial_sums(ARM, BASE, trial)
    for name in ("gram", "moment", "power", "row", "torque", "count"):
        found, expected = getattr(parted, name), getattr(whole, name)
        assert np.abs(found - expected).max() <= 1e-11 * np.abs(expected).max()
