"""Torque in N·mm shows in masses that are too heavy for their size, where gravity pulls."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Arm, Control, Friction, Joint, Link
from arm.newton_euler import inverse_dynamics
from fitter.data.plausibility.refusal import Refusal
from fitter.data.plausibility.torque_unit import look
from tests.fitter.data.plausibility.conftest import changed


def milli(motion):
    return changed(motion, tau=1e3 * motion.columns["tau"])


@pytest.mark.parametrize("seed", range(3))
def test_thousandfold_masses_are_asked_about(arm, clean, seed):
    motion = clean(seed)
    assert look(motion, arm) is motion
    with pytest.raises(Refusal, match=r"carries .* against gravity, at least .* kg .* N·mm or mN·m"):
        look(milli(motion), arm)


def test_a_first_joint_that_gravity_does_not_reach_is_passed_over(clean):
    rod = Link(2.0, (0.15, 0.0, 0.0), (0.004, 0.06, 0.06, 0.0, 0.0, 0.0))
    arm = Arm("upright", (Joint(d_m=0.2, link=rod), Joint(alpha_rad=np.pi / 2, a_m=0.3, link=rod)))
    motion = clean()
    q = motion.columns["q"]
    dq = np.gradient(q, motion.t, axis=0)
    motion = changed(motion, tau=inverse_dynamics(arm, q, dq, np.gradient(dq, motion.t, axis=0)))
    assert look(motion, arm) is motion
    with pytest.raises(Refusal, match="tau2 carries"):
        look(milli(motion), arm)


def test_a_unit_that_is_stated_is_believed(arm, clean):
    motion = replace(milli(clean()), stated=frozenset({"tau1", "tau2"}))
    assert look(motion, arm) is motion


def test_nothing_is_known_without_gravity_lengths_or_a_measured_torque(arm, clean):
    motion = milli(clean())
    for blind in (
        replace(arm, gravity_m_s2=(0.0, 0.0, 0.0)),
        arm.with_joints(a_m=np.zeros(2), d_m=np.zeros(2)),
        replace(arm, control=Control("pd", (10.0, 10.0), (-1.0, -1.0))),
    ):
        assert look(motion, blind) is motion


def test_friction_and_rotors_carry_no_weight(arm, clean):
    """A strong, stiff drive on a light arm: nearly all of the torque is friction and a rotor behind its gear."""
    joints = tuple(
        replace(
            joint, friction=Friction(400.0, 300.0), link=replace(joint.link, inertia_kg_m2=(0, 0, 300.0, 0, 0, 0))
        )
        for joint in arm.joints
    )
    strong, motion = replace(arm, joints=joints), clean()
    q = motion.columns["q"]
    dq = np.gradient(q, motion.t, axis=0)
    motion = changed(motion, tau=inverse_dynamics(strong, q, dq, np.gradient(dq, motion.t, axis=0)))
    assert look(motion, strong) is motion


@pytest.mark.parametrize("seed", range(3))
def test_a_motion_too_small_to_tell_weight_from_inertia_says_nothing(arm, clean, seed):
    motion = clean(seed, 1e-3)
    noise = np.random.default_rng(seed).normal(size=motion.columns["tau"].shape)
    motion = changed(motion, tau=200.0 * motion.columns["q"] + 50.0 * noise)
    assert look(motion, arm) is motion


def on_a_bench(clean):
    """Return half a kilogram at a tenth of a metre, as on a servo's test bench, and its motion."""
    arm = Arm(
        "bench",
        (Joint(a_m=0.1, link=Link(0.49, (0.1, 0.0, 0.0), (0.0, 0.0049, 0.0049, 0.0, 0.0, 0.0))),),
        gravity_m_s2=(9.81, 0.0, 0.0),
    )
    motion = clean()
    pulse = np.array([1.3, 4.1])
    angle, size = np.outer(motion.t, pulse), np.array([[0.8], [0.4]])
    q, dq, ddq = (
        np.sin(angle) @ size,
        np.cos(angle) @ (pulse[:, None] * size),
        -np.sin(angle) @ (pulse[:, None] ** 2 * size),
    )
    tau = inverse_dynamics(arm, q, dq, ddq)
    return arm, replace(motion, columns={"q": q, "tau": tau})


def test_a_weight_on_a_short_lever_is_believed(clean):
    arm, motion = on_a_bench(clean)
    assert look(motion, arm) is motion
    with pytest.raises(Refusal, match="solid steel"):
        look(milli(motion), arm)


@pytest.mark.parametrize(("times", "asked"), [(8.0, False), (12.0, True), (8000.0, True), (12000.0, False)])
def test_as_heavy_as_a_ball_of_steel_is_asked_about_unless_a_thousandth_is_as_well(clean, times, asked):
    """A ball of 0.1 m across weighs 4.11 kg, 8.4 times the weight at the end of the lever."""
    arm, motion = on_a_bench(clean)
    motion = changed(motion, tau=times * motion.columns["tau"])
    if asked:
        with pytest.raises(Refusal, match="solid steel"):
            look(motion, arm)
    else:
        assert look(motion, arm) is motion


def test_no_torque_or_none_that_is_felt_says_nothing(arm, clean):
    motion = clean()
    q = motion.columns["q"]
    for blank in (replace(motion, columns={"q": q}), changed(motion, tau=np.zeros_like(q))):
        assert look(blank, arm) is blank


@pytest.mark.parametrize(("noise", "times"), [(0.0, 10.275), (0.2, 10.85), (1.0, 14.085)])
def test_what_is_carried_counts_by_two_standard_errors_less(clean, noise, times):
    """The lever turns by 0.96 rad, whose sine is 0.82; noise in units of the torque's own size."""
    arm, motion = on_a_bench(clean)
    tau = motion.columns["tau"]
    tau = tau + noise * tau.std() * np.random.default_rng(0).normal(size=tau.shape)
    for factor, asked in ((0.99, False), (1.01, True), (990.0, True), (1010.0, False)):
        try:
            look(changed(motion, tau=factor * times * tau), arm)
            assert not asked
        except Refusal:
            assert asked


@pytest.mark.parametrize(
    ("first", "alpha", "down", "words"),
    [
        (Joint(a_m=0.3, d_m=0.1), 0.0, (0.0, -9.81, 0.0), "reaches 0.6 m beyond joint 1"),
        (Joint(d_m=0.2), np.pi / 2, (0.0, 0.0, -9.81), "reaches 0.25 m beyond joint 2"),
    ],
)
def test_an_arm_reaches_by_the_lengths_beyond_a_joint(clean, first, alpha, down, words):
    """By none along its own axis; 0.03 m across and 0.04 m along make 0.05."""
    rods = [Link(5.0, (length / 2.0, 0.0, 0.0), (0.0, 0.05, 0.05, 0.0, 0.0, 0.0)) for length in (0.3, 0.2, 0.03)]
    joints = (first, Joint(alpha_rad=alpha, a_m=0.2, d_m=0.15), Joint(a_m=0.03, d_m=0.04))
    joints = tuple(replace(joint, link=rod) for joint, rod in zip(joints, rods, strict=True))
    arm, motion = Arm("three", joints, gravity_m_s2=down), clean()
    q = np.column_stack([motion.columns["q"], np.sin(3.1 * motion.t)])
    dq = np.gradient(q, motion.t, axis=0)
    tau = inverse_dynamics(arm, q, dq, np.gradient(dq, motion.t, axis=0))
    motion = replace(motion, columns={"q": q, "tau": tau})
    assert look(motion, arm) is motion
    with pytest.raises(Refusal, match=words):
        look(milli(motion), arm)


def test_one_joint_whose_unit_is_stated_is_enough(arm, clean):
    motion = replace(milli(clean()), stated=frozenset({"tau2"}))
    assert look(motion, arm) is motion
    with pytest.raises(Refusal):
        look(replace(motion, stated=frozenset({"tau3", "q1"})), arm)


def test_a_joint_that_slides_or_no_angle_says_nothing(arm, clean):
    motion = milli(clean())
    slides = replace(arm, joints=(arm.joints[0], replace(arm.joints[1], type="prismatic")))
    assert look(motion, slides) is motion
    blank = replace(motion, columns={"tau": motion.columns["tau"]})
    assert look(blank, arm) is blank
