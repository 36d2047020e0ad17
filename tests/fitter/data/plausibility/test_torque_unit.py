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


def test_a_weight_on_a_short_lever_is_believed(clean):
    """Half a kilogram at a tenth of a metre, as on a servo's test bench."""
    arm = Arm(
        "bench",
        (Joint(a_m=0.1, link=Link(0.49, (0.1, 0.0, 0.0), (0.0, 0.0049, 0.0049, 0.0, 0.0, 0.0))),),
        gravity_m_s2=(9.81, 0.0, 0.0),
    )
    motion = clean()
    q = motion.columns["q"][:, :1]
    dq = np.gradient(q, motion.t, axis=0)
    tau = inverse_dynamics(arm, q, dq, np.gradient(dq, motion.t, axis=0))
    motion = replace(motion, columns={"q": q, "tau": tau})
    assert look(motion, arm) is motion
    with pytest.raises(Refusal, match="solid steel"):
        look(milli(motion), arm)
