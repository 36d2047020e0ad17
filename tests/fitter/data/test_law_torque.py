"""What a control law asks for, by hand."""

from dataclasses import replace

import numpy as np
import pytest

from arm.drive_state import DriveState
from arm.model import Control
from fitter.data.law_torque import law_torque
from fitter.data.trial import Trial
from limbcal.errors import ConfigError, DataError

CONTROL = Control("pda", (8.0, 4.0), (-0.5, -0.25), (-0.1, -0.2))
KP, KV, KA = np.array(CONTROL.kp), np.array(CONTROL.kv), np.array(CONTROL.ka)
Q, DQ, DDQ, REF = np.random.default_rng(0).normal(size=(4, 6, 2))
TRIAL = Trial("run", 0.01 * np.arange(6.0), 0.01, Q, DQ, DDQ, ref=REF)


def test_without_columns_of_the_drives_the_law_s_own_gains_count():
    own = KV * DQ + KA * DDQ
    np.testing.assert_allclose(law_torque(CONTROL, TRIAL), KP * (REF - Q) + own)
    filtered = replace(TRIAL, ref_filtered=REF + 1.0)
    np.testing.assert_allclose(law_torque(CONTROL, filtered), KP * (REF + 1.0 - Q) + own)


def test_gains_and_switches_of_the_trial_overrule_them():
    kp, on = np.full((6, 2), 3.0), np.ones((6, 2), dtype=bool)
    on[2:, 1] = False
    found = law_torque(CONTROL, replace(TRIAL, drives=DriveState(on, kp)))
    np.testing.assert_allclose(found, on * (3.0 * (REF - Q) + KV * DQ + KA * DDQ))


def test_gains_and_target_come_half_a_step_late_beside_filtered_angles():
    """With a filter that changes nothing: each is the mean of a sample and the one before."""
    kp = np.repeat([[2.0, 6.0]], 6, axis=0)
    kp[3:] = [4.0, 1.0]
    inner = slice(1, 5)
    trial = Trial(
        *("run", 0.01 * np.arange(4.0), 0.01, Q[inner], DQ[inner], DDQ[inner]),
        **{
            "ref": REF[inner],
            "ref_filtered": REF[inner],
            "drives": DriveState(np.ones((4, 2), dtype=bool), kp[inner]),
        },
        **{"whole": {"q": Q, "ref": REF, "kp": kp}, "trimmed": 1},
    )
    before = np.maximum(np.arange(6) - 1, 0)
    pull = (kp * REF + kp[before] * REF[before]) / 2.0 - (kp + kp[before]) / 2.0 * Q
    expected = pull[inner] + KV * DQ[inner] + KA * DDQ[inner]
    np.testing.assert_allclose(law_torque(CONTROL, trial), expected)


def test_what_is_not_given_is_said():
    with pytest.raises(DataError, match="trial run: has no target; expected columns ref1…"):
        law_torque(CONTROL, replace(TRIAL, ref=None))
    with pytest.raises(ConfigError, match="control.law is 'measured'"):
        law_torque(Control(), TRIAL)


def test_without_the_whole_trial_gains_are_those_of_each_sample():
    drives = DriveState(np.ones((6, 2), dtype=bool), np.full((6, 2), 3.0))
    for more in ({"ref_filtered": REF + 1.0}, {"whole": {"q": Q, "ref": REF, "kp": np.full((6, 2), 9.0)}}):
        found = law_torque(CONTROL, replace(TRIAL, drives=drives, **more))
        np.testing.assert_allclose(found, 3.0 * (REF - Q) + KV * DQ + KA * DDQ)
