"""Time that is not in seconds is asked about."""

import re
from dataclasses import replace

import numpy as np
import pytest

from fitter.data.motions import Measured
from fitter.data.plausibility.refusal import Refusal
from fitter.data.plausibility.time_unit import look
from tests.fitter.data.plausibility.conftest import changed

UNITS = [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("unit", "factor"), UNITS)
def test_each_unit_is_named(arm, clean, seed, unit, factor):
    motion = clean(seed)
    with pytest.raises(Refusal, match=f"clean.csv: .* is t in {unit}"):
        look(replace(motion, t=factor * motion.t), arm)


def test_a_velocity_tells_it_whatever_the_magnitude(arm, clean):
    motion = clean(0, 0.02)
    dq = np.gradient(motion.columns["q"], motion.t, axis=0)
    given = changed(motion, dq=dq)
    assert look(given, arm) is given
    with pytest.raises(Refusal, match="times the slope of q"):
        look(replace(given, t=1e3 * given.t), arm)


def test_a_unit_that_is_stated_is_believed(arm, clean):
    slow = replace(clean(), t=1e3 * clean().t, stated=frozenset({"t"}))
    assert look(slow, arm) is slow


def standing(step, n=20):
    return Measured("still", "still.csv", 0, step * np.arange(n), {"q": np.ones((n, 2))})


@pytest.mark.parametrize(("step", "asked"), [(4.0, False), (5.0, True)])
def test_of_joints_that_stand_the_rate_alone_tells(arm, step, asked):
    """Every 5 s is a two-hundredth of a usual rate, and every 5 ms next to a usual one."""
    motion = standing(step)
    if asked:
        with pytest.raises(Refusal, match="a sample comes every 5 s and joint 1 moves at 0 rad/s: is t in milli"):
            look(motion, arm)
    else:
        assert look(motion, arm) is motion


def moving(step, speeds, n=50):
    t = step * np.arange(n)
    return Measured("ramp", "ramp.csv", 0, t, {"q": np.outer(t, speeds)})


@pytest.mark.parametrize(
    ("kinds", "speeds", "words"),
    [
        ("rr", (0.0, 0.002), "joint 2 moves at 0.002 rad/s"),  # one that stands says nothing
        ("rr", (0.003, 0.001), "joint 1 moves at 0.003 rad/s"),
        ("pp", (0.0003, 0.0), "joint 1 moves at 0.0003 m/s"),
        ("rp", (0.0005, 0.001), "joint 2 moves at 0.001 m/s"),
        ("rr", (0.031, 0.031), "joint 1 moves at 0.031 rad/s"),  # 19 to 1 for what is rare a hundredfold
        ("rr", (0.035, 0.035), None),
        ("pp", (0.0047, 0.0047), "joint 1 moves at 0.0047 m/s"),
        ("pp", (0.0053, 0.0053), None),
        ("rr", (0.002, 2.0), None),  # that of one joint is usual
        ("rp", (0.002, 0.3), None),
    ],
)
def test_the_joint_whose_speed_is_most_usual_tells(arm, kinds, speeds, words):
    types = {"r": "revolute", "p": "prismatic"}
    mixed = replace(
        arm, joints=tuple(replace(joint, type=types[k]) for joint, k in zip(arm.joints, kinds, strict=True))
    )
    motion = moving(1.0, np.array(speeds))
    if words is None:
        assert look(motion, mixed) is motion
    else:
        with pytest.raises(Refusal, match=rf"a sample comes every 1 s and {words}: is t in milliseconds"):
            look(motion, mixed)


@pytest.mark.parametrize(("unit", "factor"), UNITS)
@pytest.mark.parametrize(
    ("ratio", "named"), [(0.65, False), (0.68, True), (1.0, True), (1.47, True), (1.53, False)]
)
def test_a_velocity_may_be_off_its_slope_by_half(arm, unit, factor, ratio, named):
    motion = moving(0.01 * factor, np.array([0.5, 0.0]) / factor)
    motion = changed(motion, dq=np.tile([0.5 * ratio, 0.0], (50, 1)))
    if named:
        seen = re.escape(f"dq is {factor * ratio:.4g} times the slope of q over t")
        with pytest.raises(Refusal, match=f"{seen}: is t in {unit}"):
            look(motion, arm)
    else:
        assert look(motion, arm) is motion


def test_a_velocity_that_tells_nothing_leaves_it_to_the_magnitude(arm):
    motion = moving(1.0, np.array([0.002, 0.001]))
    with pytest.raises(Refusal, match="a sample comes every 1 s"):
        look(changed(motion, dq=np.zeros((50, 2))), arm)


def test_two_samples_or_no_angle_are_asked_nothing(arm):
    for motion in (
        standing(5.0, 2),
        Measured("tip", "tip.csv", 0, 5.0 * np.arange(9.0), {"tip": np.zeros((9, 3))}),
    ):
        assert look(motion, arm) is motion
    with pytest.raises(Refusal):
        look(standing(5.0, 3), arm)


def test_stamps_that_rise_by_one_may_be_the_samples_numbers(arm, clean):
    motion = clean(0)
    with pytest.raises(Refusal, match=r"is t in milliseconds, or a sample's number\?.*--rate-hz 500"):
        look(replace(motion, t=np.arange(len(motion.t), dtype=np.float64)), arm)
    with pytest.raises(Refusal, match=r"is t in milliseconds\?"):
        look(replace(motion, t=1e3 * motion.t), arm)
