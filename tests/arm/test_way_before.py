"""Where the torque was on its way before the first sample."""

from dataclasses import replace

import numpy as np
import pytest

from arm.drive import BEFORE, LAGGED0, PLAY0, TWIST0, Commands
from arm.effects.effect_table import changed, effect_table
from arm.model import Control
from arm.newton_euler import bias_torque
from arm.room import make_room
from arm.simulation import simulate
from arm.way_before import set_way

DT = 1e-3


def way_of(arm, drive, q, dq=(0.0,), given=False, law=(8.0, -2.0, 0.0)):
    """Return the way before, and the state that becomes the links'."""
    arm = changed(arm)
    room, state = make_room(arm.n_joint, 1), np.array([q, dq], dtype=float)
    commands = Commands(np.array(law, dtype=float)[:, None], given, np.array([drive], dtype=float), DT, 0.0)
    set_way(arm, commands, effect_table(arm), 1, state, room.way)
    return room.way.state, state


def test_a_moving_arm_had_its_first_command_already(wheel, having):
    late = having(wheel, "actuator_lag", time_constant_s=0.1)
    x, _ = way_of(late, [0.7], [0.2], [0.5])
    assert x[BEFORE, 0] == x[LAGGED0, 0] == pytest.approx(8.0 * 0.5 - 2.0 * 0.5)


@pytest.mark.parametrize("name", ["actuator_lag", "actuator_delay"])
def test_a_resting_joint_was_held_by_its_friction(wheel, having, rubbing, name):
    """Of what holds it, next to the first command: from -0.4 to 0.4 N m, static friction from -0.9 to 0.9."""
    number = {"actuator_lag": "time_constant_s", "actuator_delay": "delay_s"}[name]
    late = having(rubbing(wheel, 0.0, 0.4, 0.0), name, **{number: 0.1})
    for target, before in ((1.0, 0.4), (-1.0, -0.4), (0.02, 0.16)):
        assert way_of(late, [target], [0.0])[0][BEFORE, 0] == pytest.approx(before)
    sticky = having(rubbing(wheel, 0.0, 0.4, 0.9), name, **{number: 0.1})
    assert way_of(sticky, [1.0], [0.0])[0][BEFORE, 0] == pytest.approx(0.9)


def test_effects_hold_a_resting_joint_too(wheel, having, rubbing):
    """A spring pulls with 0.6 N m one way; friction of 0.4 + 0.1 N m holds about that."""
    late = having(rubbing(wheel, 0.0, 0.4, 0.0), "actuator_lag", time_constant_s=0.1)
    late = having(late, "joint_spring", stiffness_N_m_rad=3.0, rest_angle_rad=0.2)
    late = having(late, "coulomb", coulomb_N_m=0.1)
    assert way_of(late, [5.0], [0.0])[0][BEFORE, 0] == pytest.approx(-0.6 + 0.5)
    assert way_of(late, [-5.0], [0.0])[0][BEFORE, 0] == pytest.approx(-0.6 - 0.5)


def test_a_weak_gain_asked_for_more(wheel, having, rubbing):
    late = having(rubbing(wheel, 0.0, 0.4, 0.0), "actuator_lag", time_constant_s=0.1)
    assert way_of(having(late, "gain_error", factor=0.5), [1.0], [0.0])[0][BEFORE, 0] == pytest.approx(0.8)
    assert way_of(having(late, "gain_error", factor=0.0), [1.0], [0.0])[0][BEFORE, 0] == pytest.approx(8.0)


def test_friction_by_the_load_counts_what_arrives(wheel, having, rubbing):
    """Of 8 N m arrive 4, and of these a tenth holds beside 0.4 N m."""
    late = having(rubbing(wheel, 0.0, 0.4, 0.0), "actuator_lag", time_constant_s=0.1)
    late = having(having(late, "gain_error", factor=0.5), "load_friction", coefficient=0.1)
    assert way_of(late, [1.0], [0.0])[0][BEFORE, 0] == pytest.approx(0.8 / 0.5)


def test_without_delay_and_lag_the_first_command_is_there(wheel, having, rubbing):
    x, state = way_of(having(rubbing(wheel, 0.0, 0.4, 0.0), "gain_error", factor=0.5), [1.0], [0.0])
    assert x[BEFORE, 0] == 8.0 and state[0, 0] == 0.0


def test_the_links_angle_is_behind_play_and_twist(wheel, having):
    """Half of 6 N m, cut to 2.5 N m, twists 50 N m/rad, and half a gap of 0.1 rad lies before it."""
    arm = having(having(wheel, "backlash", gap_rad=0.1), "torque_saturation", limit_N_m=2.5)
    arm = having(arm, "joint_elasticity", stiffness_N_m_rad=50.0, damping_N_m_s=0.2)
    arm = having(arm, "gain_error", factor=0.5)
    for sign in (1.0, -1.0):
        x, state = way_of(arm, [6.0 * sign], [0.3], given=True)
        assert x[PLAY0, 0] == 0.05 * sign and x[TWIST0, 0] == pytest.approx(2.5 / 50.0 * sign)
        assert state[0, 0] == pytest.approx(0.3 - 0.1 * sign)


@pytest.fixture
def held_arm(arm, rubbing):
    """Return an arm without friction, an angle, and the target with which its controller holds it there."""
    smooth = rubbing(replace(arm, joints=arm.joints[1:], sensors=(), tip=None), 0.1, 0.0, 0.0)
    smooth = replace(smooth, control=Control("pd", arm.control.kp[1:], arm.control.kv[1:]))
    q0 = np.array([0.4, -0.3])
    return smooth, q0, q0 + bias_torque(smooth, q0[None], np.zeros((1, 2)))[0] / np.array(smooth.control.kp)


def test_an_arm_that_rests_has_been_held_before(held_arm, having):
    """Late drives hold the arm where its controller balances gravity: nothing moves until a new target arrives."""
    arm, q0, target = held_arm
    for name, number in (("actuator_delay", "delay_s"), ("actuator_lag", "time_constant_s")):
        late = having(having(arm, name, joint=1, **{number: 0.1}), name, joint=2, **{number: 0.1})
        motion = simulate(late, np.tile(target, (200, 1)), DT, q0)
        np.testing.assert_allclose(motion.q, np.tile(q0, (200, 1)), rtol=0, atol=1e-9)
        moved = simulate(late, np.tile(target + 0.3, (200, 1)), DT, q0)
        early = slice(0, 95) if name == "actuator_delay" else slice(0, 1)
        np.testing.assert_allclose(moved.q[early], np.tile(q0, (200, 1))[early], rtol=0, atol=1e-9)
        assert np.abs(moved.q[-1] - q0).max() > 1e-3
