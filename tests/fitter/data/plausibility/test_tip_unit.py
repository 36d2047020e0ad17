"""A tip in millimetres is asked about."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.motions import Measured
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


def path(ratio, length=1.0, n=50):
    """Return a motion whose two joints turn by half a radian each while the tip goes so far, in a slant."""
    way = np.linspace(0.0, 1.0, n)[:, None]
    columns = {"q": way * [0.5, -0.5], "tip": ratio * length * way * [0.6, 0.0, -0.8]}
    return Measured("path", "path.csv", 0, 0.01 * np.arange(n), columns)


@pytest.mark.parametrize(
    ("length", "ratio", "unit"),
    [
        (0.6, 140.0, None),  # where lengths are known: 19 to 1 for what is rare a hundredfold
        (0.6, 150.0, "mm"),
        (0.6, 1000.0, "mm"),
        (0.0, 39.0, None),  # where they are not, half a metre is usual
        (0.0, 50.0, "cm"),
        (0.0, 163.0, "cm"),
        (0.0, 168.0, "mm"),
    ],
)
def test_another_unit_is_named_where_metres_are_next_to_impossible(arm, length, ratio, unit):
    sized = arm.with_joints(a_m=np.full(2, length / 2.0), d_m=np.zeros(2))
    motion = path(ratio, length or 0.5)
    if unit is None:
        assert look(motion, sized) is motion
        return
    named = {"cm": "centimetres", "mm": "millimetres"}[unit]
    moved = f"moves over {0.8 * ratio * (length or 0.5):.4g} m"
    reaches = f"arm {arm.name} reaches {length:.3g} m: is it in {named}"
    with pytest.raises(
        Refusal, match=rf"{moved}, and {reaches}.*tipx=tipx:{unit},tipy=tipy:{unit},tipz=tipz:{unit}"
    ):
        look(motion, sized)


@pytest.mark.parametrize("axis", ["tipx", "tipy", "tipz"])
def test_one_axis_whose_unit_is_stated_is_enough(arm, axis):
    motion = replace(path(1000.0), stated=frozenset({axis, "t"}))
    assert look(motion, arm) is motion
    with pytest.raises(Refusal):
        look(replace(motion, stated=frozenset({"t"})), arm)


def test_joints_that_slide_or_stand_and_two_samples_say_nothing(arm):
    motion = path(1000.0)
    slides = replace(arm, joints=(replace(arm.joints[0], type="prismatic"), arm.joints[1]))
    assert look(motion, slides) is motion
    for blank in (
        motion.rows(0, 2, "two"),
        changed(motion, q=np.zeros((50, 2))),
        changed(motion, tip=np.full((50, 3), 1e6)),
        replace(motion, columns={"q": motion.columns["q"]}),
    ):
        assert look(blank, arm) is blank
    with pytest.raises(Refusal):
        look(path(1000.0, n=3), arm)
