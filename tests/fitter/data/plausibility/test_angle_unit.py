"""Angles in degrees are asked about."""

import re
from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Control, Joint
from fitter.data.motions import Measured
from fitter.data.plausibility.angle_unit import look
from fitter.data.plausibility.refusal import Refusal
from tests.arm.conftest import draw_arm
from tests.fitter.data.plausibility.conftest import changed
from tests.fitter.dynamics.test_torque_wiring import driven


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("without", [(), ("tau",), ("tip",), ("tau", "tip")])
def test_degrees_are_named_by_torque_tip_or_magnitude(arm, clean, seed, without):
    motion = clean(seed)
    columns = {role: values for role, values in motion.columns.items() if role not in without}
    assert look(replace(motion, columns=columns), arm).columns is columns
    ranges = np.rad2deg(np.ptp(columns["q"], axis=0))
    moves = re.escape(f"joint {ranges.argmax() + 1} moves {ranges.max():.3g} rad to and fro")
    with pytest.raises(Refusal, match=rf"{moves} .*degrees\?.*q=q\{{j\}}:deg"):
        look(replace(motion, columns={**columns, "q": np.rad2deg(columns["q"])}), arm)


def test_the_torque_tells_small_motions_in_degrees(arm, clean):
    motion = clean(2, 0.1)
    with pytest.raises(Refusal, match="degrees"):
        look(changed(motion, q=np.rad2deg(motion.columns["q"])), arm)


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("q", r"the slope of q is 57\.[23]\d* times dq: is q in degrees, dq not"),
        ("dq", r"the slope of q is 0\.0174\d* times dq: is dq in degrees, q not"),
    ],
)
def test_a_velocity_of_another_unit_is_named(arm, clean, column, words):
    motion = clean(1)
    dq = np.gradient(motion.columns["q"], motion.t, axis=0)
    given = changed(motion, dq=dq)
    with pytest.raises(Refusal, match=words):
        look(changed(given, **{column: np.rad2deg(given.columns[column])}), arm)


def test_a_unit_that_is_stated_is_believed(arm, clean):
    motion = clean()
    stated = replace(motion, stated=frozenset({"q1", "q2"}), columns={"q": np.rad2deg(motion.columns["q"])})
    assert look(stated, arm) is stated


def test_a_wheel_to_and_fro_at_a_wheel_s_speed_is_none():
    t = np.arange(0.0, 60.0, 0.01)
    motion = Measured("w", "w", 0, t, {"q": np.column_stack([37.0 * np.sin(0.2 * t), np.sin(t)])})
    assert look(motion, load_arm("dd-arm")) is motion


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("joint", [1, 2])
@pytest.mark.parametrize("size", [1.0, 0.2])
def test_one_joint_of_two_in_degrees_is_named(arm, clean, seed, joint, size):
    motion = clean(seed, size)
    q = motion.columns["q"].copy()
    q[:, joint - 1] *= 180.0 / np.pi
    words = rf'is q{joint} in degrees, the others not\?.*"q{joint}=q{joint}:deg"'
    with pytest.raises(Refusal, match=words):
        look(changed(motion, q=q), arm)


@pytest.mark.parametrize("column", ["q", "dq"])
def test_the_velocity_of_one_joint_of_another_unit_is_named(arm, clean, column):
    motion = clean(1)
    motion = changed(motion, dq=np.gradient(motion.columns["q"], motion.t, axis=0))
    values = motion.columns[column] * np.array([1.0, 180.0 / np.pi])
    with pytest.raises(
        Refusal, match=rf"the slope of q2 is .* times dq2: is {column}2 in degrees\?.*{column}2={column}2:deg"
    ):
        look(changed(motion, **{column: values}), arm)


def test_of_six_joints_one_is_named(draw_six):
    arm, motion = draw_six
    assert look(motion, arm) is motion
    q = motion.columns["q"] * np.where(np.arange(6) == 4, 180.0 / np.pi, 1.0)
    with pytest.raises(Refusal, match="is q5 in degrees"):
        look(changed(motion, q=q), arm)


@pytest.fixture(scope="module")
def draw_six():
    """Return an arm of six joints whose torque is measured, and a motion of it."""
    rng = np.random.default_rng(6)
    arm = replace(draw_arm(rng, 6, prismatic=False), control=Control())
    trial = driven(arm, 6)
    return arm, Measured("six", "six.csv", 0, trial.t, {"q": trial.q, "tau": trial.tau})


@pytest.mark.parametrize("seed", range(8))
def test_a_torque_with_another_fault_does_not_speak_of_degrees(arm, clean, seed):
    motion = clean(seed)
    tau = motion.columns["tau"]
    held = motion.columns["q"].copy()
    held[300:340, 1] = held[300, 1]
    for fault in ({"tau": tau[:, ::-1]}, {"tau": tau * np.array([-1.0, 1.0])}, {"q": held}):
        other = changed(motion, **fault)
        assert look(other, arm) is other


def test_a_tip_says_nothing_of_an_arm_without_lengths(clean):
    motion = clean(1)
    no_arm = Arm("none", (Joint(), Joint()))
    without = {role: values for role, values in motion.columns.items() if role != "tip"}
    for factor in (1.0, 180.0 / np.pi):
        told = []
        for columns in (motion.columns, without):
            one = replace(motion, columns={**columns, "q": factor * columns["q"]})
            try:
                look(one, no_arm)
                told.append("")
            except Refusal as refusal:
                told.append(str(refusal))
        assert told[0] == told[1]


def test_a_tip_that_moves_while_the_joints_stand_says_nothing_of_them(arm, clean):
    motion = clean(1)
    still = replace(motion, columns={"q": np.zeros_like(motion.columns["q"]), "tip": motion.columns["tip"]})
    assert look(still, arm) is still
