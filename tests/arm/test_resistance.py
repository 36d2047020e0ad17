"""With how much a joint resists: friction, effects in each direction, and loads that are taken up."""

from dataclasses import replace

import numpy as np
import pytest

from arm.chain import chain_of
from arm.drive import GUESS, TORQUE, Commands
from arm.effects.effect_table import effect_table
from arm.effects.payload import with_load
from arm.model import Friction
from arm.resistance import friction_alone, resist, take_up
from arm.room import make_room
from arm.simulation import simulate


@pytest.fixture
def rough(arm):
    """Return an arm whose first joint sticks, whose second one slides, and whose third one has no friction."""
    levels = (Friction(0.1, 0.4, 0.9), Friction(0.1, 0.3, 0.2), Friction(0.1))
    return replace(arm, joints=tuple(replace(j, friction=f) for j, f in zip(arm.joints, levels, strict=True)))


def resisting(arm, dq, mode, q=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0), t=0.0, law=None, guess=0.0):
    """Return net torque, sliding friction and hold of joints that effects resist."""
    room = make_room(3, 0)
    room.net[:] = 0.0
    room.way.state[TORQUE], room.way.state[GUESS] = torque, guess
    commands = Commands(np.zeros((3, 3)) if law is None else law, False, np.zeros((1, 3)), 1e-3, 0.0)
    q, dq, mode = (np.array(x, dtype=float) for x in (q, dq, mode))
    resist(chain_of(arm), commands, effect_table(arm), t, q, dq, mode, room)
    return room.net, room.slip, room.hold


def test_without_effects_what_is_static_or_slides_holds(rough):
    room = make_room(3, 0)
    friction_alone(chain_of(rough), effect_table(rough), room)
    assert room.slip.tolist() == [0.4, 0.3, 0.0] and room.hold.tolist() == [0.9, 0.3, 0.0]
    assert room.directed.tolist() == [True, True, False]


def test_friction_that_pushes_holds_nothing(rough, having):
    pushing = replace(rough, joints=(replace(rough.joints[0], friction=Friction(0.0, -0.4)), *rough.joints[1:]))
    room = make_room(3, 0)
    friction_alone(chain_of(pushing), effect_table(having(pushing, "coulomb", joint=3, coulomb_N_m=0.1)), room)
    assert room.hold[0] == 0.0 and room.slip[0] == -0.4
    assert room.directed.all()


def test_static_friction_alone_has_a_direction(rough):
    sticky = replace(rough, joints=(*rough.joints[:2], replace(rough.joints[2], friction=Friction(0.0, 0.0, 0.1))))
    room = make_room(3, 0)
    friction_alone(chain_of(sticky), effect_table(sticky), room)
    assert room.directed[2] and room.hold[2] == 0.1


def test_a_sliding_joint_is_resisted_in_its_direction(rough, having):
    arm = having(rough, "coulomb_asymmetry", joint=2, difference_N_m=0.3)
    arm = having(having(arm, "viscous", joint=2, viscous_N_m_s=0.5), "coulomb", joint=3, coulomb_N_m=0.2)
    net, slip, hold = resisting(arm, [1.0, -2.0, -1.0], [1.0, -1.0, -1.0])
    np.testing.assert_allclose(net, [0.0, -0.3 + 0.5 * 2.0, 0.2], atol=1e-15)
    assert slip.tolist() == [0.4, 0.3, 0.0] and hold.tolist() == [0.9, 0.3, 0.0]


def test_a_resting_joint_is_held_about_the_mean(rough, having):
    arm = having(rough, "coulomb", joint=2, coulomb_N_m=0.5)
    arm = having(arm, "joint_spring", joint=2, stiffness_N_m_rad=2.0, rest_angle_rad=0.1)
    arm = having(arm, "coulomb", joint=3, coulomb_N_m=-0.5)
    net, slip, hold = resisting(arm, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], q=(0.0, 0.4, 0.0))
    np.testing.assert_allclose(net, [0.0, -2.0 * 0.3, 0.0], atol=1e-15)
    np.testing.assert_allclose(slip, [0.4, 0.8, -0.5], atol=1e-15)
    np.testing.assert_allclose(hold, [0.9, 0.8, 0.0], atol=1e-15)


def test_load_friction_counts_the_acceleration_that_is_fed_back(rough, having):
    arm, law = having(rough, "load_friction", joint=3, coefficient=0.1), np.zeros((3, 3))
    law[2] = -2.0
    net, _, _ = resisting(arm, [1.0, 1.0, 1.0], [1.0, 1.0, 1.0], torque=(0.0, 0.0, 3.0), law=law, guess=5.0)
    np.testing.assert_allclose(net, [0.0, 0.0, -0.1 * abs(3.0 - 2.0 * 5.0)])


def test_effects_see_their_joints_own_friction_and_the_time(rough, having):
    arm = having(having(rough, "thermal_drift", joint=1, rate_1_s=0.1), "thermal_drift", joint=2, rate_1_s=0.1)
    net, _, _ = resisting(arm, [2.0, -3.0, 0.0], [1.0, -1.0, 0.0], t=2.0)
    np.testing.assert_allclose(net, [-0.2 * (0.2 + 0.4), 0.2 * (0.3 + 0.3), 0.0])


def test_loads_are_taken_up_when_it_is_time(arm, having):
    loaded = having(having(arm, "payload", mass_kg=0.7, since_s=2.0), "payload", mass_kg=0.4, since_s=5.0)
    chain, effects = chain_of(loaded), effect_table(loaded)
    assert take_up(effects, chain, 1.999, 0) == 0
    np.testing.assert_array_equal(chain.inertial, chain_of(arm).inertial)
    assert take_up(effects, chain, 2.0, 0) == 1 and take_up(effects, chain, 4.0, 1) == 1
    np.testing.assert_allclose(chain.inertial, chain_of(with_load(arm, 0.7)).inertial, rtol=0, atol=1e-14)
    assert take_up(effects, chain, 9.0, 1) == 2
    np.testing.assert_allclose(chain.inertial, chain_of(with_load(arm, 1.1)).inertial, rtol=0, atol=1e-14)


def test_a_joint_that_effects_alone_hold_sticks_and_stays(wheel, having):
    """It has no friction of its own; where it comes to rest it moves no more, to the last bit."""
    arm = having(wheel, "load_friction", coefficient=0.1)
    arm = having(arm, "stribeck", amplitude_N_m=0.5, velocity_rad_s=0.3)
    motion = simulate(arm, np.full((6000, 1), 0.3), 1e-3, np.zeros(1))
    moving = np.flatnonzero(motion.dq[:, 0])
    assert 100 < len(moving) < 5500
    np.testing.assert_array_equal(np.unique(motion.q[moving[-1] + 1 :]), motion.q[-1])
    assert abs(motion.tau[-1, 0]) * 0.9 <= 0.5
