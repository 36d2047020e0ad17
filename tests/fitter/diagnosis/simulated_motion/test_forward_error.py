"""How far a simulated arm goes astray."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.simulated_motion.forward_error import forward_error
from fitter.dynamics.evaluation import motion_error


def test_the_right_arm_stays_and_a_wrong_one_goes_astray(true_arm, wrong_arm, trials):
    right, wrong = (forward_error(arm, trials, 0.5) for arm in (true_arm, wrong_arm))
    assert right.total_rms < 0.2 * wrong.total_rms
    assert right.mean.shape == right.rms.shape == right.max.shape == (2,)
    assert right.total_mean <= right.total_rms <= right.total_max == right.max.max()


def test_without_effects_it_is_what_a_calibration_says(true_arm, trials):
    plain = replace(true_arm, effects=())
    off = np.concatenate([motion_error(plain, trial, 0.5) for trial in trials])
    assert forward_error(plain, trials, 0.5).total_rms == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-6)
