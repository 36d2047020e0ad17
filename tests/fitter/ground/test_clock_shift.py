"""The forces' clock against the motion's."""

import numpy as np
import pytest

from fitter.data.derivatives import lowpass
from fitter.ground.clock_shift import clock_shift


def pair(shift_s, noise=0.02):
    rng = np.random.default_rng(3)
    t = np.arange(3000) * 0.002
    fine = lowpass(rng.normal(size=len(t)), 0.002, 2.0)
    fine /= fine.std()
    at = np.arange(60, 540) * 0.01
    measured = np.interp(at - shift_s, t, fine) + noise * rng.normal(size=len(at))
    return 0.8 * np.interp(at, t, fine), lowpass(measured, 0.01, 6.0)


@pytest.mark.parametrize("shift_s", [-0.05, 0.008, 0.12])
def test_a_shift_is_found(shift_s):
    found = clock_shift(*pair(shift_s), 0.01, 6.0)
    assert abs(found.shift_s - shift_s) < 0.002


def test_clocks_that_agree_and_persons_who_stand_are_left_alone():
    assert clock_shift(*pair(0.0), 0.01, 6.0).shift_s == 0.0
    rng = np.random.default_rng(0)
    assert clock_shift(rng.normal(size=400), rng.normal(size=400), 0.01, 6.0).shift_s == 0.0


def test_what_may_not_be_compared_shifts_nothing():
    predicted, measured = pair(0.05)
    measured[150:250] = 0.0
    usable = np.ones(len(measured), dtype=bool)
    usable[150:250] = False
    assert abs(clock_shift(predicted, measured, 0.01, 6.0, usable).shift_s - 0.05) < 0.004
    assert clock_shift(predicted, measured, 0.01, 6.0, np.zeros_like(usable)).shift_s == 0.0
