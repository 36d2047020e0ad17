"""Torque that an arm with its effects leaves."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Control, Effect
from fitter.data.trials import undriven
from fitter.diagnosis.simulated_motion.torque_error import torque_left, torque_rms
from fitter.dynamics.evaluation import torque_rms as torque_rms_of_a_calibration
from tests.fitter.diagnosis.simulated_motion.conftest import driven_trials


def test_an_arm_that_is_right_leaves_less(true_arm, wrong_arm, trials):
    right, wrong = torque_rms(true_arm, trials), torque_rms(wrong_arm, trials)
    assert right[1] < 0.5 * wrong[1]


def test_without_effects_it_is_what_a_calibration_says(true_arm, trials):
    plain = replace(true_arm, effects=())
    assert torque_rms(plain, trials) == pytest.approx(torque_rms_of_a_calibration(plain, trials))


def test_a_torque_that_comes_slowly_and_not_all_is_followed(true_arm):
    slow = Effect("actuator_lag", {"time_constant_s": 0.03}, joints=(1,))
    weak = Effect("gain_error", {"factor": 0.8}, joints=(1,))
    arm = replace(true_arm, effects=(*true_arm.effects, slow, weak))
    trial = driven_trials(arm, 1)[0]
    inner = slice(200, -200)
    left = torque_left(arm, trial, trial.tau_measured, 1)[inner, 0]
    assert np.std(left) < 0.2 * np.std(torque_left(true_arm, trial, trial.tau_measured, 1)[inner, 0])


def test_nothing_is_left_of_no_torque(true_arm, trials):
    assert torque_rms(replace(true_arm, control=Control()), [undriven(trial) for trial in trials]) is None
