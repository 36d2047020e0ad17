"""Errors of the tip's displacement, against errors that were put in."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.data.trials import Trial
from fitter.kinematics.tip_error import tip_score
from limbcal.errors import DataError

ARM = load_arm("dd-arm")


def trial(scale=1.0):
    """Return a motion that begins with a rest, its tip measured by an arm ``scale`` times as large."""
    angle = np.concatenate([np.zeros(500), 1.0 - np.cos(np.linspace(0.0, 6.0, 1500))])
    q = np.column_stack([angle, 0.5 + angle])
    tip = scale * tip_position(ARM, q)
    return Trial("one", np.arange(len(q)) * 0.01, 0.01, q, np.gradient(q, 0.01, axis=0), 0 * q, tip=tip)


@pytest.mark.parametrize("about", ["rest", "mean"])
def test_the_true_arm_explains_all(about):
    score = tip_score(ARM, [trial()], about)
    assert score.max_mm == pytest.approx(0.0, abs=1e-9) and score.explained == pytest.approx(1.0)


@pytest.mark.parametrize("about", ["rest", "mean"])
def test_of_a_tip_twice_as_far_half_is_missing(about):
    score = tip_score(ARM, [trial(2.0)], about)
    assert score.explained == pytest.approx(0.75)  # half of the displacement, a quarter of its power


def test_a_tip_that_does_not_move_explains_nothing_and_no_trial_is_refused():
    still = trial()
    still = replace(still, q=0.0 * still.q, tip=0.0 * still.tip)
    assert np.isnan(tip_score(ARM, [still]).explained)
    with pytest.raises(DataError, match="at least one"):
        tip_score(ARM, [])
