"""A tip in millimetres is asked about."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.plausibility.refusal import Refusal
from fitter.data.plausibility.tip_unit import look
from tests.fitter.data.plausibility.conftest import changed


@pytest.mark.parametrize("seed", range(3))
def test_millimetres_are_named(arm, clean, seed):
    motion = clean(seed)
    assert look(motion, arm) is motion
    with pytest.raises(Refusal, match="the tip moves over .* millimetres"):
        look(changed(motion, tip=1e3 * motion.columns["tip"]), arm)


def test_lengths_that_are_a_guess_are_no_reason_to_ask(arm, clean):
    for factor in (0.3, 3.0):
        guess = arm.with_joints(a_m=factor * np.array([joint.a_m for joint in arm.joints]))
        motion = clean()
        assert look(motion, guess) is motion


def test_an_arm_without_lengths_and_a_stated_unit(arm, clean):
    blank = arm.with_joints(a_m=np.zeros(2), d_m=np.zeros(2))
    motion = clean()
    in_mm = changed(motion, tip=1e3 * motion.columns["tip"])
    assert look(motion, blank) is motion
    with pytest.raises(Refusal):
        look(in_mm, blank)
    stated = replace(in_mm, stated=frozenset({"tipx", "tipy", "tipz"}))
    assert look(stated, arm) is stated
