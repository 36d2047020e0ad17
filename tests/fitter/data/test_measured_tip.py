"""The tip that dead reckoning measures."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions, tip_position
from fitter.data.measured_tip import measured_tip, with_measured_tip
from fitter.data.trial import Trial
from limbcal.errors import ConfigError, DataError

ARM = load_arm("dd-arm")
angles = st.lists(st.floats(-3.0, 3.0), min_size=2, max_size=2)


def moved(q):
    positions = sensor_positions(ARM, q)
    return positions - positions[:1]


@settings(max_examples=50, deadline=None)
@given(st.lists(angles, min_size=2, max_size=20), st.floats(0.05, 1.0), st.floats(0.05, 1.0))
def test_it_is_the_tips_displacement_whatever_lengths_the_arm_file_has(rows, a1, a2):
    q = np.array(rows)
    guessed = ARM.with_joints(a_m=np.array([a1, a2]))
    tip = measured_tip(guessed, q, moved(q))
    reached = tip_position(ARM, q)
    assert np.allclose(tip - tip[0], reached - reached[0], atol=1e-12)


def test_what_cannot_be_a_tip():
    q = np.zeros((5, 2))
    with pytest.raises(ConfigError, match="arm 'dd-arm' has no .tip., expected the sensor that measures it"):
        measured_tip(replace(ARM, tip=None), q, moved(q))
    with pytest.raises(DataError, match=r"points have shape \(5, 3, 3\), expected 4 sensors as arm 'dd-arm' has"):
        measured_tip(ARM, q, moved(q)[:, :3])


def test_a_trial_gets_a_tip_only_where_there_are_points_and_no_tip():
    q = np.linspace(0.0, 1.0, 40).reshape(20, 2)
    plain = Trial("a", 0.01 * np.arange(20.0), 0.01, q, q, q)
    assert with_measured_tip(ARM, plain) is plain
    followed = replace(plain, points=moved(q))
    tip = with_measured_tip(ARM, followed).tip
    assert tip is not None and np.array_equal(tip, measured_tip(ARM, q, moved(q)))
    tracked = replace(followed, tip=np.zeros((20, 3)))
    assert with_measured_tip(ARM, tracked) is tracked
