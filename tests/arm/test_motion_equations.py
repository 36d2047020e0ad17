"""The equations of motion set up in place, against those of the whole arm, and their solution against numpy's."""

from dataclasses import replace

import numpy as np
import pytest

from arm.chain import chain_of
from arm.drive import Commands
from arm.effects.effect_table import effect_table
from arm.motion_equations import acceleration, equations, solve
from arm.newton_euler import bias_torque, mass_matrix
from arm.room import make_room


def set_up(arm, q, dq, law, drive, given=False, share=0.0, mode=None):
    """Return the room in which the equations at a share of the first step stand."""
    room = make_room(arm.n_joint, 0)
    commands = Commands(np.array(law, dtype=float), given, np.array(drive, dtype=float), 1e-2, 3.0)
    mode = np.sign(dq) if mode is None else mode
    equations(chain_of(arm), commands, effect_table(arm), 0, share, 0.0, q, dq, mode, room)
    return room


@pytest.fixture(scope="module")
def state():
    rng = np.random.default_rng(1)
    return rng.uniform(-2.0, 2.0, 3), rng.uniform(0.2, 1.0, 3) * [1.0, -1.0, 1.0]


@pytest.mark.parametrize("n", [1, 2, 5, 7])
def test_elimination_finds_what_numpy_finds(n):
    rng = np.random.default_rng(n)
    A, x = rng.normal(size=(n, n)), rng.normal(size=n)
    expected = np.linalg.solve(A, x)
    solve(A.copy(), x)
    np.testing.assert_allclose(x, expected, rtol=1e-9)


def test_elimination_goes_round_a_zero_on_the_diagonal():
    A, x = np.array([[0.0, 2.0, 0.0], [3.0, 0.0, 1.0], [0.0, 0.0, 4.0]]), np.array([2.0, 7.0, 16.0])
    solve(A, x)
    np.testing.assert_allclose(x, [1.0, 1.0, 4.0], rtol=1e-15)


def test_the_largest_pivot_keeps_small_numbers_exact():
    A, x = np.array([[1e-20, 1.0], [-1.0, 1.0]]), np.array([1.0, 3.0])
    solve(A, x)
    np.testing.assert_allclose(x, [-2.0, 1.0], rtol=1e-15)


def test_mass_and_net_torque_are_those_of_the_arm(arm, state):
    q, dq = state
    kp, kv, ref = np.array([3.0, 5.0, 7.0]), np.array([-1.0, -2.0, -0.5]), np.array([0.3, -0.2, 0.9])
    room = set_up(arm, q, dq, [kp, kv, np.zeros(3)], [ref])
    np.testing.assert_allclose(room.M, mass_matrix(arm, q)[0], rtol=0, atol=1e-12)
    coulomb = 0.2 * np.sign(dq)  # is no part of the net torque, but one of the arm's bias torque
    expected = kp * (ref - q) + kv * dq - (bias_torque(arm, q, dq)[0] - coulomb)
    np.testing.assert_allclose(room.net, expected, rtol=0, atol=1e-12)


def test_a_given_torque_runs_straight_between_samples(arm, state):
    q, dq = state
    torque = np.array([[1.0, 2.0, 3.0], [2.0, 0.0, 7.0]])
    at = [set_up(arm, q, dq, np.zeros((3, 3)), torque, given=True, share=share).net for share in (0.0, 0.25)]
    np.testing.assert_allclose(at[1] - at[0], [0.25, -0.5, 1.0], rtol=0, atol=1e-12)


def test_fed_back_acceleration_and_rotors_join_the_mass(arm, state, having):
    law = [np.zeros(3), np.zeros(3), np.array([-1.0, -2.0, -0.4])]
    rotor = having(arm, "rotor_inertia", joint=2, inertia_kg_m2=0.3)
    room = set_up(rotor, *state, law, np.zeros((1, 3)))
    expected = mass_matrix(arm, state[0])[0] + np.diag([1.0, 2.0 + 0.3, 0.4])
    np.testing.assert_allclose(room.M, expected, rtol=0, atol=1e-12)


def test_effects_count_at_the_runs_time(arm, state, having):
    """Half a step of 10 ms after the third second."""
    hum = having(arm, "periodic_disturbance", joint=3, amplitude_N_m=0.5, frequency_hz=50.0, phase_rad=0.0)
    nets = [set_up(one, *state, np.zeros((3, 3)), np.zeros((1, 3)), share=0.25).net for one in (hum, arm)]
    np.testing.assert_allclose(nets[0] - nets[1], [0.0, 0.0, 0.5 * np.sin(100.0 * np.pi * 3.0025)], atol=1e-12)


def test_drives_between_controller_and_joint_count(arm, state, having):
    law = [np.full(3, 4.0), np.zeros(3), np.zeros(3)]
    weak = having(arm, "gain_error", joint=2, factor=0.25)
    nets = [set_up(one, *state, law, np.ones((1, 3))).net for one in (arm, weak)]
    np.testing.assert_allclose(nets[0] - nets[1], [0.0, 0.75 * 4.0 * (1.0 - state[0][1]), 0.0], atol=1e-12)


def test_a_stuck_joint_does_not_accelerate_and_the_others_obey(arm, state):
    q, dq = state
    room = set_up(arm, q, dq, np.zeros((3, 3)), np.zeros((1, 3)))
    room.slip[:] = 0.2
    mode, ddq = np.array([1.0, 0.0, -1.0]), np.empty(3)
    acceleration(mode, room, ddq)
    assert ddq[1] == 0.0
    np.testing.assert_allclose((room.M @ ddq)[[0, 2]], (room.net - room.slip * mode)[[0, 2]], rtol=0, atol=1e-11)
    acceleration(np.sign(dq), room, ddq)
    np.testing.assert_allclose(room.M @ ddq + bias_torque(arm, q, dq)[0], 0.0, atol=1e-10)


def test_a_tree_of_links_has_the_same_equations(random_arm):
    rng = np.random.default_rng(3)
    tree = random_arm(rng, 5, friction=False, branching=True)
    q, dq = rng.uniform(-2.0, 2.0, (2, 5))
    room = set_up(replace(tree, effects=()), q, dq, np.zeros((3, 5)), np.zeros((1, 5)))
    np.testing.assert_allclose(room.M, mass_matrix(tree, q)[0], rtol=0, atol=1e-11)
    np.testing.assert_allclose(-room.net, bias_torque(tree, q, dq)[0], rtol=0, atol=1e-11)
