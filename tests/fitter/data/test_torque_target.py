"""The torque that a trial is explained with."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from fitter.data.torque_target import (
    has_unknown_target,
    motion_begins,
    target_holds_from,
    target_of,
    torque_target,
)
from fitter.data.trial_filter import settling_samples
from limbcal.errors import DataError

ARM = load_arm("dd-arm")
MEASURED = replace(ARM, control=Control())


def test_the_law_or_the_measured_torque(bench_trials):
    trial = bench_trials[0]
    assert np.allclose(torque_target(ARM, trial), trial.tau, atol=1e-12)
    assert torque_target(MEASURED, trial) is trial.tau
    with pytest.raises(DataError, match=r"bench#0: has no torque"):
        torque_target(MEASURED, replace(trial, tau=None))


def test_an_unknown_target_is_one_constant_a_joint(bench_trials):
    trial = replace(bench_trials[1], ref=None)
    assert has_unknown_target(ARM, trial)
    assert not has_unknown_target(MEASURED, trial)
    assert not has_unknown_target(ARM, bench_trials[1])
    missing = bench_trials[1].tau - torque_target(ARM, trial)
    assert np.allclose(missing, np.array(ARM.control.kp) * bench_trials[1].ref, atol=1e-9)


def test_the_start_of_the_motion_and_its_target_are_found(bench_trials):
    for trial in bench_trials:
        start = motion_begins(trial)
        assert abs(trial.t[start] - 0.5) <= 0.004  # the bench rests for half a second
        estimated = target_of(ARM, replace(trial, ref=None))
        assert np.allclose(estimated[start + 1 :], trial.ref[start + 1 :], atol=1e-6)
        assert np.allclose(estimated[:start], trial.q[:start], atol=1e-3)
        assert target_of(ARM, trial) is trial.ref


def test_a_trial_that_never_moves_begins_at_once(bench_trials):
    trial = bench_trials[0]
    assert motion_begins(replace(trial, dq=0.0 * trial.dq)) == 0


def test_a_joint_without_gain_has_no_target_but_where_it_rested(bench_trials):
    half = replace(ARM, control=replace(ARM.control, kp=(9.5, 0.0)))
    trial = replace(bench_trials[0], ref=None)
    start = motion_begins(trial)
    assert np.allclose(target_of(half, trial)[:, 1], trial.q[:start, 1].mean())


@pytest.mark.parametrize("spare", [-1, 0, 1, 2])
def test_a_target_holds_once_the_filter_has_settled_in_the_first_half(bench_trials, spare):
    trial = replace(bench_trials[0], cutoff_hz=8.0)
    begin, settling = motion_begins(trial), settling_samples(trial.dt_s, 8.0)
    n = 2 * (begin + settling + spare)
    short = replace(trial, t=trial.t[:n], q=trial.q[:n], dq=trial.dq[:n], ddq=trial.ddq[:n])
    assert motion_begins(short) == begin
    assert target_holds_from(short) == (begin + settling if spare > 0 else begin)
