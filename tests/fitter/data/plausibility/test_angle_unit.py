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


def test_accelerations_in_degrees_are_refused(arm, clean):
    motion = clean(1)
    dq = np.gradient(motion.columns["q"], motion.t, axis=0)
    ddq = np.gradient(dq, motion.t, axis=0)
    assert look(changed(motion, dq=dq, ddq=ddq), arm).columns["ddq"] is ddq
    with pytest.raises(Refusal, match=r"is ddq in degrees, dq not\?.*ddq=ddq\{j\}:deg"):
        look(changed(motion, dq=dq, ddq=np.rad2deg(ddq)), arm)


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
        refusals = []
        for columns in (motion.columns, without):
            one = replace(motion, columns={**columns, "q": factor * columns["q"]})
            try:
                look(one, no_arm)
                refusals.append("")
            except Refusal as refusal:
                refusals.append(str(refusal))
        assert refusals[0] == refusals[1]


def test_a_tip_that_moves_while_the_joints_stand_says_nothing_of_them(arm, clean):
    motion = clean(1)
    still = replace(motion, columns={"q": np.zeros_like(motion.columns["q"]), "tip": motion.columns["tip"]})
    assert look(still, arm) is still


ONE = Arm("one", (Joint(a_m=0.3),))


def swinging(size, samples, **columns):
    """Return 4 s of an angle that goes evenly to and fro over so much, in `n` samples, at 100 Hz."""
    wave = np.abs(np.arange(400) % samples - samples / 2) / (samples / 2)
    return Measured("m", "m.csv", 0, 0.01 * np.arange(400), {"q": size * wave[:, None], **columns})


def is_asked(motion, arm=ONE):
    try:
        assert look(motion, arm) is motion
    except Refusal:
        return True
    return False


@pytest.mark.parametrize(("samples", "size"), [(10, 10.66), (40, 20.28), (200, 59.46)])
def test_the_larger_a_range_the_faster_it_is_asked_about(samples, size):
    """Where ranges and speeds make degrees 19 times as likely, at odds of 1 to 99 before."""
    assert not is_asked(swinging(0.99 * size, samples))
    assert is_asked(swinging(1.01 * size, samples))


@pytest.mark.parametrize(("metres", "size"), [(0.3, 14.65), (3.0, 33.2), (30.0, 91.5)])
def test_a_tip_that_hardly_moves_makes_degrees_likelier(metres, size):
    tip = np.outer(swinging(metres, 40).columns["q"], [0.0, 1.0, 0.0])
    assert not is_asked(swinging(0.99 * size, 40, tip=tip))
    assert is_asked(swinging(1.01 * size, 40, tip=tip))


@pytest.mark.parametrize(("samples", "asked"), [(2, False), (3, True)])
def test_two_samples_or_no_angle_are_asked_nothing(samples, asked):
    assert is_asked(swinging(1e4, 40).rows(0, samples, "few")) == asked
    tip = Measured("m", "m.csv", 0, 0.01 * np.arange(400), {"tip": np.ones((400, 3))})
    assert not is_asked(tip)


def test_joints_that_slide_or_whose_unit_is_stated_are_not_asked_about():
    motion = swinging(1e4, 40)
    assert not is_asked(motion, Arm("slide", (Joint("prismatic"),)))
    assert not is_asked(replace(motion, stated=frozenset({"q1"})))
    assert is_asked(replace(motion, stated=frozenset({"q2"})))
    both = changed(motion, q=motion.columns["q"] * [1.0, 1.0])
    two = Arm("two", (Joint(a_m=0.3), Joint(a_m=0.3)))
    with pytest.raises(Refusal, match=r"joint 2 moves 1e\+04 rad .*: degrees\?.*q=q\{j\}:deg"):
        look(replace(both, stated=frozenset({"q1"})), two)


@pytest.mark.parametrize(
    ("in_degrees", "words"),
    [
        ((0, 1, 2), r'are q1 and q2 and q3 in degrees.*"q1=q1:deg,q2=q2:deg,q3=q3:deg" \(q1=q1:rad,q2=q2:rad'),
        ((3,), "is q4 in degrees"),
        ((0, 1, 2, 3), r"rad/s: degrees\?"),
    ],
)
def test_of_four_joints_one_all_but_one_or_all_are_named(in_degrees, words):
    four = Arm("four", tuple(Joint(a_m=0.3) for _ in range(4)))
    scale = np.where(np.isin(np.arange(4), in_degrees), 180.0 / np.pi, 1.0)
    motion = swinging(1.5, 100)
    motion = changed(motion, q=motion.columns["q"] * scale)
    with pytest.raises(Refusal, match=words):
        look(motion, four)


def with_velocity(ratios):
    """Return joints that go evenly, and velocities that are a multiple of their slopes."""
    t = 0.01 * np.arange(100)
    slope = np.full(len(ratios), 0.5)
    q, dq = np.outer(t, slope), np.tile(slope * ratios, (100, 1))
    return Measured("m", "m.csv", 0, t, {"q": q, "dq": dq})


@pytest.mark.parametrize(
    ("ratio", "words"),
    [
        (1.0, ""),
        (57.3 * 1.45, r"times dq: is dq in degrees, q not\?"),
        (57.3 * 1.55, ""),
        (57.3 / 1.45, r"times dq: is dq in degrees, q not\?"),
        (57.3 / 1.55, ""),
        (1.45 / 57.3, r"times dq: is q in degrees, dq not\?"),
        (1.55 / 57.3, ""),
        (1.0 / 1.4 / 57.3, r"times dq: is q in degrees, dq not\?"),
        (1.0 / 1.55 / 57.3, ""),
    ],
)
def test_a_velocity_may_be_off_its_slope_by_half(ratio, words):
    two = Arm("two", (Joint(a_m=0.3), Joint(a_m=0.3)))
    motion = with_velocity(np.array([ratio, ratio]))
    if words:
        with pytest.raises(Refusal, match=rf"the slope of q is {re.escape(f'{1.0 / ratio:.4g}')} {words}"):
            look(motion, two)
    else:
        assert look(motion, two) is motion


def test_joints_whose_velocity_does_not_fit_are_named():
    three = Arm("three", tuple(Joint(a_m=0.3) for _ in range(3)))
    with pytest.raises(
        Refusal, match=r"q2 is 0\.0174\d times dq2: are dq2 and dq3 in degrees\?.*dq2=dq2:deg,dq3=dq3:deg"
    ):
        look(with_velocity(np.array([1.0, 57.3, 57.3])), three)
    with pytest.raises(Refusal, match=r"q1 is 57\.3 times dq1: is q1 in degrees\?.*q1=q1:deg"):
        look(with_velocity(np.array([1.0 / 57.3, 1.0, 1.0])), three)


@pytest.mark.parametrize(("samples", "size"), [(10, 6.913), (40, 12.267), (200, 27.81)])
def test_two_joints_alike_are_asked_about_together(samples, size):
    """Where it is sure that some are in degrees, and of neither that it is."""
    two = Arm("two", (Joint(a_m=0.3), Joint(a_m=0.3)))
    for factor, asked in ((0.99, False), (1.01, True)):
        motion = swinging(factor * size, samples)
        motion = changed(motion, q=motion.columns["q"] * [1.0, 1.0])
        assert is_asked(motion, two) == asked
        if asked:
            with pytest.raises(Refusal, match=r"degrees\?.*q=q\{j\}:deg"):
                look(motion, two)


def test_a_path_of_less_than_a_radian_tells_by_its_tip_too():
    for size, asked in ((8.95, False), (9.13, True)):
        tip = np.outer(swinging(0.003, 800).columns["q"], [0.0, 1.0, 0.0])
        assert is_asked(swinging(size, 800, tip=tip)) == asked


@pytest.mark.parametrize(("noise", "asked"), [(0.65, True), (0.69, False)])
def test_a_torque_tells_the_less_the_less_is_explained(noise, asked):
    """Of 0.2 rad in degrees, at a pendulum whose torque has noise of about its own size."""
    t = 0.01 * np.arange(400)
    angle = (0.12 * np.sin(2.0 * t) + 0.075 * np.sin(3.7 * t + 1.0))[:, None]
    tau = np.sin(angle) + 0.5 * np.cos(angle) + noise * np.random.default_rng(0).normal(size=(400, 1))
    hanging = Arm("hanging", (Joint(a_m=0.3),), gravity_m_s2=(0.0, -9.81, 0.0))
    assert is_asked(Measured("m", "m.csv", 0, t, {"q": np.rad2deg(angle), "tau": tau}), hanging) == asked
    assert not is_asked(Measured("m", "m.csv", 0, t, {"q": angle, "tau": tau}), hanging)
