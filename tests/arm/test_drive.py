"""The torque's way from the controller to the joint, and the angle's way back."""

import numpy as np
import pytest

from arm.drive import (
    BEFORE,
    COMMAND,
    ENTERED,
    ENTERED0,
    GUESS,
    LAGGED,
    LAGGED0,
    PLAY,
    PLAY0,
    PLAY_SPEED,
    SHARE,
    SLOPE,
    TARGET,
    TARGET0,
    THROUGH,
    TORQUE,
    TWIST,
    TWIST0,
    TWIST_SPEED,
    Commands,
    begin_stretch,
    delayed,
    drive_at,
    end_stretch,
    go_its_way,
    next_jump,
    through_play,
    transmitted,
)
from arm.effects.effect_table import no_effects
from arm.effects.joint_numbers import DAMPING, DELAY, FACTOR, GAP, LAG, LIMIT, STIFFNESS
from arm.room import make_room
from arm.simulation import simulate

DT = 1e-3


def commands_of(drive, given=False, kp=8.0, kv=-2.0, ka=0.0, dt=0.1):
    law = np.array([[kp], [kv], [ka]])
    return Commands(law, given, np.array(drive, dtype=float)[:, None], dt, 0.0)


def numbers_of(rows):
    table = no_effects(1)
    for row, value in rows.items():
        table.numbers[row, 0] = value
    return table


def test_a_target_is_held_and_a_torque_runs_straight():
    out = np.empty(1)
    for given, expected in ((False, [1.0, 1.0, 4.0]), (True, [1.0, 1.75, 4.0])):
        found = []
        for k, share in ((0, 0.0), (0, 0.25), (1, 0.5)):  # after the last sample it stays
            drive_at(commands_of([1.0, 4.0], given), k, share, out)
            found.append(out[0])
        assert found == expected


def test_a_late_torque_is_that_of_the_samples_before():
    commands, way = commands_of([1.0, 4.0, 2.0], given=True), make_room(1, 0).way
    way.state[BEFORE] = 9.0
    late = [
        delayed(commands, way, k, share, 0.01, 0.05, 0) for k, share in ((0, 0.25), (0, 0.75), (1, 0.0), (2, 0.25))
    ]
    np.testing.assert_allclose(late, [9.0, 1.75, 2.5, 2.5])


def test_a_late_command_runs_straight_through_each_step():
    commands, way = commands_of([1.0] * 3), make_room(1, 3).way
    way.past[:, :, 0] = [[1.0, 2.0], [5.0, 7.0], [11.0, 0.0]]
    way.state[SLOPE] = 30.0  # of the step that runs
    late = [delayed(commands, way, 2, share, 0.01, 0.05, 0) for share in (0.0, 0.25, 0.75)]
    np.testing.assert_allclose(late, [6.0, 6.5, 11.0 + 0.25 * 0.1 * 30.0])


def test_where_a_command_jumped_both_sides_are_known():
    """A stretch that begins there has what came after; one that ends there has what was before."""
    commands, way = commands_of([1.0] * 3), make_room(1, 3).way
    way.past[:, :, 0] = [[1.0, 2.0], [5.0, 7.0], [11.0, 0.0]]
    assert delayed(commands, way, 2, 0.0, 0.0, 0.1, 0) == pytest.approx(5.0)
    assert delayed(commands, way, 2, 0.0, 0.05, 0.1, 0) == pytest.approx(2.0)


def test_the_next_jump_arrives_a_delay_later():
    commands, effects, way = commands_of([1.0] * 4), numbers_of({DELAY: 0.13}), make_room(1, 4).way
    way.past[:, :, 0] = [[3.0, 3.0], [5.0, 5.0], [5.0, 5.0], [0.0, 0.0]]
    way.state[BEFORE] = 3.0
    assert next_jump(commands, effects, way, 2, 0.0) == pytest.approx(0.3)  # from 3 to 5 at the second sample
    assert next_jump(commands, effects, way, 2, 0.3) == 1.0
    assert next_jump(commands, effects, way, 1, 0.0) == 1.0  # the first command was there before
    way.state[BEFORE] = 2.0
    assert next_jump(commands, effects, way, 1, 0.0) == pytest.approx(0.3)
    assert next_jump(commands, effects, way, 0, 0.0) == 1.0
    assert next_jump(commands, no_effects(1), way, 1, 0.0) == 1.0


def test_a_given_torque_jumps_at_its_first_sample_alone():
    commands, effects, way = (
        commands_of([3.0, 9.0, 0.0], given=True),
        numbers_of({DELAY: 0.13}),
        make_room(1, 0).way,
    )
    assert next_jump(commands, effects, way, 1, 0.0) == pytest.approx(0.3)
    assert next_jump(commands, effects, way, 2, 0.0) == 1.0


def test_what_a_spring_transmits_is_its_stiffness_and_damping():
    """``k x + d x'`` is the torque, and the command is that of the motor's own angle."""
    x, numbers = make_room(1, 0).way.state[:, 0], numbers_of({STIFFNESS: 60.0, DAMPING: 2.0}).numbers[:, 0]
    x[TWIST0], x[TARGET0] = 0.02, 0.05
    for h in (0.0, 0.03):
        torque = transmitted(5.0, 8.0, -2.0, 0.4, 0.9, numbers, h, 1.0, x)
        assert torque == pytest.approx(60.0 * x[TWIST] + 2.0 * x[TWIST_SPEED])
        assert x[COMMAND] == pytest.approx(5.0 - 8.0 * x[TWIST] - 2.0 * x[TWIST_SPEED])
        assert torque == pytest.approx(0.4 + 0.9 * x[COMMAND])
    assert x[TARGET] == pytest.approx((0.4 + 0.9 * 5.0) / (60.0 + 0.9 * 8.0))


def test_a_twist_goes_on_smoothly_from_where_it_was():
    x, numbers = make_room(1, 0).way.state[:, 0], numbers_of({STIFFNESS: 60.0, DAMPING: 2.0}).numbers[:, 0]
    x[TWIST0], x[TARGET0] = 0.02, 0.05
    found = []
    for h in (0.0, 0.02 - 1e-6, 0.02, 0.02 + 1e-6, 1e-6):
        asked = (0.05 + 3.0 * h) * (60.0 + 8.0)  # what the twist tends to grows by 3 rad/s
        transmitted(asked, 8.0, -2.0, 0.0, 1.0, numbers, h, 1.0, x)
        found.append((x[TWIST], x[TWIST_SPEED]))
    assert found[0][0] == 0.02 and found[0][1] == pytest.approx((0.05 - 0.02) * 68.0 / 4.0)
    assert (found[3][0] - found[1][0]) / 2e-6 == pytest.approx(found[2][1], rel=1e-6)
    np.testing.assert_allclose(found[4], found[0], rtol=1e-4)


def test_a_play_tends_to_its_side_within_milliseconds():
    x, numbers = make_room(1, 0).way.state[:, 0], numbers_of({GAP: 0.1}).numbers[:, 0]
    x[PLAY0] = -0.05
    torque = transmitted(5.0, 8.0, -2.0, 0.0, 1.0, numbers, 0.002, 1.0, x)
    assert x[PLAY] == pytest.approx(0.05 - 0.1 / np.e) and x[PLAY_SPEED] == pytest.approx(0.1 / np.e / 0.002)
    assert torque == x[COMMAND] == pytest.approx(5.0 - 2.0 * x[PLAY_SPEED] - 8.0 * x[PLAY])


@pytest.mark.parametrize(("asked", "sign"), [(9.0, 1), (-9.0, -1), (0.1, 0)])
def test_a_play_pushes_at_one_side_or_passes_nothing_on(asked, sign):
    x, numbers = make_room(1, 0).way.state[:, 0], numbers_of({GAP: 0.1}).numbers[:, 0]
    torque = through_play(asked, 8.0, -0.01, 0.0, 1.0, numbers, 0.05, x)
    assert np.sign(torque) == sign or abs(torque) < 1e-12
    assert x[PLAY] == pytest.approx(0.05 * sign if sign else asked / 8.0, rel=1e-2)


def test_where_nothing_pushes_the_play_stays():
    x, numbers = make_room(1, 0).way.state[:, 0], numbers_of({GAP: 0.1}).numbers[:, 0]
    x[PLAY0] = 0.02
    assert through_play(0.0, 0.0, 0.0, 0.0, 1.0, numbers, 0.01, x) == 0.0
    assert x[PLAY] == pytest.approx(0.02) and x[PLAY_SPEED] == pytest.approx(0.0)


def went(effects, h, state=None, ka=0.0):
    """Return the state of one joint at 0.2 rad and 0.5 rad/s whose target is 0.7, a while into a stretch."""
    way, commands = make_room(1, 1).way, commands_of([0.7], ka=ka)
    for row, value in (state or {}).items():
        way.state[row] = value
    go_its_way(commands, effects, way, 0, 0.0, h, np.array([0.2]), np.array([0.5]), np.array([0.7]))
    return way.state[:, 0]


def test_a_lag_is_the_exact_solution_of_a_straight_command():
    """``T x' = y - x`` with y from 1 to 3 N m, by the series of its solution."""
    x = went(numbers_of({LAG: 0.05}), 0.02, {ENTERED0: 1.0, LAGGED0: 0.4})
    rate, faded = (3.0 - 1.0) / 0.02, np.exp(-0.02 / 0.05)
    assert x[COMMAND] == x[ENTERED] == pytest.approx(3.0)  # 8 (0.7 - 0.2) - 2 0.5
    assert x[LAGGED] == pytest.approx(3.0 - 0.05 * rate + (0.4 - 1.0 + 0.05 * rate) * faded)
    assert x[TORQUE] == pytest.approx(x[LAGGED])


def test_gain_and_limit_come_after_the_lag():
    assert went(numbers_of({FACTOR: 0.5}), 0.02)[TORQUE] == pytest.approx(1.5)
    x = went(numbers_of({FACTOR: 0.5, LIMIT: 1.2}), 0.02)
    assert x[TORQUE] == 1.2 and x[SHARE] == 0.0 and x[COMMAND] == pytest.approx(3.0)
    x = went(numbers_of({FACTOR: -0.5, LIMIT: 1.5}), 0.02)
    assert x[TORQUE] == pytest.approx(-1.5) and x[SHARE] == -0.5  # just not cut


def test_a_limit_counts_the_acceleration_that_is_fed_back():
    x = went(numbers_of({LIMIT: 4.0}), 0.02, {GUESS: 9.0}, ka=-1.0)
    assert x[TORQUE] == -4.0 and x[SHARE] == 0.0
    assert went(numbers_of({LIMIT: 4.0}), 0.02, {GUESS: 6.0}, ka=-1.0)[TORQUE] == pytest.approx(3.0)


def test_a_stretch_begins_with_what_the_last_one_ended_with():
    commands, effects, way = commands_of([0.7, 0.7], ka=-1.0), numbers_of({LAG: 0.05}), make_room(1, 2).way
    q, dq, ddq, now = np.array([0.2]), np.array([0.5]), np.array([1.5]), np.empty(1)
    end_stretch(commands, effects, way, 0, 1.0, 0.02, q, dq, ddq, now)
    x = way.state[:, 0]
    assert x[LAGGED0] == x[LAGGED] != 0.0 and x[GUESS] == 1.5 and x[THROUGH] == 1.0
    assert way.past[0, 1, 0] == pytest.approx(3.0 - 1.5)
    assert begin_stretch(commands, effects, way, 1, 0.0, dq, ddq) == 1.0
    assert x[ENTERED0] == pytest.approx(3.0 - 1.5) and way.past[1, 0, 0] == pytest.approx(3.0 - 1.5)
    assert x[SLOPE] == pytest.approx(-2.0 * 1.5 - 8.0 * 0.5)


def test_lag_delay_and_gain_together(wheel, having):
    """A given sine, so long that what was before has faded, comes through with its gain and its phase."""
    both = having(having(wheel, "actuator_delay", delay_s=0.0123), "actuator_lag", time_constant_s=0.05)
    both = having(both, "gain_error", factor=0.8)
    t = np.arange(4001) * DT
    torque = np.sin(9.0 * t)[:, None]
    motion = simulate(both, torque, DT, np.zeros(1), torque=torque)
    passed = 0.8 * np.exp(1j * 9.0 * (t - 0.0123)) / (1 + 9.0j * 0.05)
    np.testing.assert_allclose(0.5 * motion.ddq[2000:, 0], passed.imag[2000:], rtol=0, atol=2e-5)


def test_play_and_twist_together(wheel, having):
    both = having(wheel, "backlash", gap_rad=0.02)
    both = having(both, "joint_elasticity", stiffness_N_m_rad=50.0, damping_N_m_s=0.2)
    torque = np.where(np.arange(2000) < 1000, 0.5, -0.5)[:, None]
    motion = simulate(both, torque, DT, np.zeros(1), torque=torque)
    settled = np.arange(2000) % 1000 > 200
    lead = 0.01 * np.sign(torque) + torque / 50.0
    np.testing.assert_allclose((motion.q - motion.link_q)[settled], lead[settled], rtol=0, atol=1e-6)
