"""Motions against solved equations, other integrators and conserved quantities."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from arm.kinematics import axis_frames
from arm.model import Arm, Control, Friction, Joint, Link
from arm.newton_euler import bias_torque, forward_dynamics, mass_matrix
from arm.simulation import simulate
from limbcal.errors import ConfigError, DataError

ROD = Link(1.0, (0.3, 0.0, 0.0), (0.01, 0.1, 0.1, 0.0, 0.0, 0.0))


def rub(arm, *levels):
    """Return the arm with the same friction in every joint: viscous, Coulomb, static."""
    return replace(arm, joints=tuple(replace(joint, friction=Friction(*levels)) for joint in arm.joints))


def drive(arm, target, seconds, step, q0=None, **options):
    ref = np.tile(np.asarray(target, dtype=float), (round(seconds / step) + 1, 1))
    return simulate(arm, ref, step, np.zeros(arm.n_joint) if q0 is None else q0, **options)


def errors_of_halvings(arm, target, seconds, coarsest, times, q0=None, **options):
    """Return the largest error of the angles for every step but the finest, which is the reference."""
    runs = [drive(arm, target, seconds, coarsest / 2**k, q0, **options).q for k in range(times)]
    return np.array([np.abs(run - runs[-1][:: 2 ** (times - 1 - k)]).max() for k, run in enumerate(runs[:-1])])


@pytest.fixture(scope="module")
def chain(random_arm):
    """Three joints of both kinds, driven softly, with no friction that jumps."""
    arm = rub(random_arm(np.random.default_rng(14), 3), 0.3, 0.0, 0.0)
    assert {joint.type for joint in arm.joints} == {"revolute", "prismatic"}
    gains = tuple(60.0 for _ in arm.joints)
    return replace(arm, control=Control("pd", gains, tuple(-0.4 * x for x in gains)))


def solved(arm, target, seconds, q0, rate):
    """Return the angles that scipy's eighth-order method finds for dq' = rate(q, dq, target)."""
    n = arm.n_joint
    run = solve_ivp(
        lambda _, x: np.concatenate([x[n:], rate(x[:n], x[n:], target)]),
        (0.0, seconds),
        np.concatenate([q0, np.zeros(n)]),
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
    )
    return run.y[:n, -1]


def test_a_smooth_chain_moves_as_scipy_has_it(chain):
    target, q0 = np.array([0.5, -0.3, 0.4]), np.array([0.1, 0.2, -0.1])
    kp, kv = np.array(chain.control.kp), np.array(chain.control.kv)

    def rate(q, dq, ref):
        return forward_dynamics(chain, q, dq, kp * (ref - q) + kv * dq)[0]

    motion = drive(chain, target, 1.0, 1.0 / 8000, q0)
    np.testing.assert_allclose(motion.q[-1], solved(chain, target, 1.0, q0, rate), rtol=0, atol=1e-10)


def test_law_6_feeds_its_own_acceleration_back(dd_arm):
    """``ka ddq`` stands on both sides of the equation: the arm moves as with the mass ``M - ka``."""
    arm = rub(replace(dd_arm, control=Control("pda", (9.5, 9.5), (-9.5, -9.5), (-1.5, -3.5))), 0.1, 0.0, 0.0)
    target = np.array([1.0, -0.7])

    def rate(q, dq, ref):
        net = 9.5 * (ref - q) - 9.5 * dq - bias_torque(arm, q, dq)[0]
        return np.linalg.solve(mass_matrix(arm, q)[0] - np.diag([-1.5, -3.5]), net)

    motion = drive(arm, target, 2.0, 1e-3)
    np.testing.assert_allclose(motion.q[-1], solved(arm, target, 2.0, np.zeros(2), rate), rtol=0, atol=1e-10)
    law = 9.5 * (motion.ref - motion.q) - 9.5 * motion.dq + np.array([-1.5, -3.5]) * motion.ddq
    np.testing.assert_allclose(motion.tau, law, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        forward_dynamics(arm, motion.q, motion.dq, motion.tau), motion.ddq, rtol=0, atol=1e-10
    )


def test_the_default_is_of_fourth_order(chain):
    errors = errors_of_halvings(chain, [0.5, -0.3, 0.4], 1.0, 1 / 250, 6)
    ratios = errors[:-1] / errors[1:]
    np.testing.assert_allclose(ratios[1:], 16.0, rtol=0.12)  # the last reference is itself only 16 times better


@pytest.mark.parametrize(
    ("target", "levels"),
    [((1.0, 0.02), (0.1, 0.3, 0.3)), ((1.0, 0.02), (0.1, 0.3, 0.5)), ((0.0, 1.0), (0.1, 0.3, 0.5))],
    ids=["stops and starts", "static friction above Coulomb", "torn loose by the other joint"],
)
def test_it_is_so_through_sticking_and_letting_go(dd_arm, target, levels):
    arm = rub(dd_arm, *levels)
    motion = drive(arm, target, 5.0, 1e-3)
    still = motion.dq == 0.0
    events = np.count_nonzero(np.diff(still.astype(int), axis=0))
    assert events >= 4
    assert np.any(still[-1])
    errors = errors_of_halvings(arm, target, 5.0, 5.0 / 500, 6)
    ratios = errors[:-1] / errors[1:]
    assert np.all(ratios > 14.0), ratios
    np.testing.assert_allclose(ratios[2:], 17.0, rtol=0.1)


def test_a_pendulum_with_friction_comes_to_rest_and_stays():
    arm = Arm("pendulum", (Joint(friction=Friction(0.05, 0.4, 0.6), link=ROD),), (0.0, -9.8, 0.0))
    motion = drive(arm, [0.0], 4.0, 1e-3, np.array([0.3]), torque=np.zeros((4001, 1)))
    rest = np.flatnonzero(motion.dq[:, 0] == 0.0)
    stopped = rest[rest > 0][0]
    assert 1.0 < motion.t[stopped] < 3.5
    np.testing.assert_array_equal(motion.q[stopped:, 0], motion.q[stopped, 0])  # to the last bit
    assert np.abs(bias_torque(rub(arm), motion.q[-1], np.zeros(1))) < 0.6


def test_a_sliding_block_stops_where_and_when_it_must():
    """Coulomb friction alone: s = m v^2 / 2f after t = m v / f, between two samples."""
    block = Arm("block", (Joint("prismatic", friction=Friction(0.0, 0.7, 0.7), link=Link(2.0)),), (0.0, 0.0, 0.0))
    motion = drive(block, [0.0], 5.0, 0.01, dq0=np.array([1.2345]), torque=np.zeros((501, 1)))
    stop_s, path = 2.0 * 1.2345 / 0.7, 2.0 * 1.2345**2 / (2 * 0.7)
    t = np.minimum(motion.t, stop_s)
    np.testing.assert_allclose(motion.q[:, 0], 1.2345 * t - 0.35 * t**2 / 2, rtol=0, atol=1e-12)
    np.testing.assert_allclose(motion.q[-1, 0], path, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(motion.dq[motion.t > stop_s], 0.0)
    np.testing.assert_array_equal(motion.ddq[motion.t > stop_s], 0.0)


def test_static_friction_holds_exactly_and_then_coulomb_friction_slides():
    """A force that grows by 1 N/s on a block that holds 1.003 N and slides with 0.4 N."""
    block = Arm(
        "block", (Joint("prismatic", friction=Friction(0.0, 0.4, 1.003), link=Link(2.0)),), (0.0, 0.0, 0.0)
    )
    t = np.arange(401) * 0.005
    motion = simulate(block, np.zeros((401, 1)), 0.005, np.array([0.1]), torque=t[:, None])
    held, s = t < 1.003, np.maximum(t - 1.003, 0.0)
    np.testing.assert_array_equal(motion.q[held], 0.1)
    np.testing.assert_array_equal(motion.dq[held], 0.0)
    q = 0.1 + ((1.003 - 0.4) * s**2 / 2 + s**3 / 6) / 2.0
    np.testing.assert_allclose(motion.q[:, 0], q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(motion.ddq[~held, 0], (t[~held] - 0.4) / 2.0, rtol=0, atol=1e-12)


def test_friction_stands_against_both_directions():
    block = Arm("block", (Joint("prismatic", friction=Friction(0.0, 0.4, 1.0), link=Link(2.0)),), (0.0, 0.0, 0.0))
    pulled = drive(block, [0.0], 1.0, 0.01, torque=np.full((101, 1), 1.5))
    pushed = drive(block, [0.0], 1.0, 0.01, torque=np.full((101, 1), -1.5))
    np.testing.assert_array_equal(pulled.q, -pushed.q)
    np.testing.assert_allclose(pulled.q[-1], 1.1 / 2.0 / 2.0, rtol=1e-13)


def test_a_frictionless_pendulum_keeps_its_energy(vertical_arm):
    arm = rub(vertical_arm, 0.0, 0.0, 0.0)
    motion = drive(arm, [0.0, 0.0], 5.0, 5e-4, np.array([0.4, -0.9]), torque=np.zeros((10001, 2)))
    kinetic = 0.5 * np.einsum("ki,kij,kj->k", motion.dq, mass_matrix(arm, motion.q), motion.dq)
    frames = axis_frames(arm, motion.q)
    coms = [
        T[:, :3, :3] @ joint.link.com_m + T[:, :3, 3]
        for T, joint in zip(frames.swapaxes(0, 1), arm.joints, strict=True)
    ]
    height = [joint.link.mass_kg * 9.80665 * com[:, 1] for joint, com in zip(arm.joints, coms, strict=True)]
    energy = kinetic + sum(height)
    assert kinetic.max() > 10.0
    np.testing.assert_allclose(energy, energy[0], rtol=0, atol=1e-7 * kinetic.max())


def test_dd_arm_under_law_5_reaches_its_target(dd_arm):
    motion = drive(dd_arm, [1.0, -0.8], 20.0, 1e-3)
    np.testing.assert_allclose(motion.q[-1], [1.0, -0.8], rtol=0, atol=0.011 / 9.5)  # but for Coulomb friction
    np.testing.assert_allclose(motion.dq[-1], 0.0, rtol=0, atol=1e-6)
    np.testing.assert_array_equal(motion.q[0], 0.0)


def test_law_7_has_no_damping(dd_arm):
    arm = rub(replace(dd_arm, control=Control("p", (9.5, 9.5))), 0.0, 0.0, 0.0)
    motion = drive(arm, [0.5, 0.0], 20.0, 1e-3)
    late = motion.q[motion.t > 15.0, 0]
    assert late.max() - late.min() > 0.5
    np.testing.assert_allclose(motion.tau, 9.5 * (motion.ref - motion.q), rtol=0, atol=1e-12)


def test_measured_torque_makes_the_motion_again(dd_arm):
    """Torque is taken to change linearly between samples, so twice as many make it four times as exact."""
    errors = []
    for step in (5e-4, 2.5e-4):
        motion = drive(dd_arm, [1.0, -0.8], 3.0, step)
        again = simulate(dd_arm, motion.ref, step, motion.q[0], torque=motion.tau)
        np.testing.assert_array_equal(again.tau, motion.tau)
        errors.append(np.abs(again.q - motion.q).max())
    assert errors[1] < 5e-5
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.05)


def test_a_motion_can_be_taken_up_where_it_was_left(dd_arm):
    whole = drive(dd_arm, [1.0, -0.8], 2.0, 1e-3)
    rest = simulate(dd_arm, whole.ref[1000:], 1e-3, whole.q[1000], whole.dq[1000])
    np.testing.assert_array_equal(rest.q, whole.q[1000:])
    np.testing.assert_array_equal(rest.t, np.arange(1001) * 1e-3)


def test_the_printed_scheme_is_of_first_order_and_comes_to_the_same(dd_arm):
    arm, target = rub(dd_arm, 0.1, 0.0, 0.0), [1.0, -0.8]
    true = drive(arm, target, 3.0, 1 / 1000).q
    errors = []
    for step in (1 / 250, 1 / 500, 1 / 1000):
        printed = drive(arm, target, 3.0, step, scheme="paper").q
        errors.append(np.abs(printed - true[:: round(step * 1000)]).max())
    assert errors[2] < 2e-3
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 2.0, rtol=0.1)


def test_read_as_printed_the_runge_kutta_step_would_be_no_law_of_motion(dd_arm):
    """With f the velocity rather than the acceleration, an arm at rest would never start under any torque."""
    f = lambda velocity: velocity  # noqa: E731 - what the print calls f
    h, velocity = 1e-3, np.zeros(2)
    k1 = h * f(velocity)
    k2 = h * f(velocity + k1 / 2)
    k3 = h * f(velocity + k2 / 2)
    k4 = h * f(velocity + k3)
    np.testing.assert_array_equal(velocity + (k1 + 2 * k2 + 2 * k3 + k4) / 6, 0.0)
    assert np.abs(drive(dd_arm, [1.0, -0.8], 0.1, h, scheme="paper").dq[-1]).min() > 0.01


def test_static_friction_holds_under_the_printed_scheme_too(dd_arm):
    arm = rub(dd_arm, 0.0, 1.0, 10.0)
    for scheme in ("rk4", "paper"):
        motion = drive(arm, [1.0, -0.9], 1.0, 1e-3, scheme=scheme)
        np.testing.assert_array_equal(motion.q, 0.0)


def test_an_arm_that_no_masses_can_have_may_run_away(dd_arm):
    arm = rub(dd_arm, -50.0, -1.0, 0.0)
    motion = drive(arm, [1.0, -0.8], 20.0, 1e-2)
    assert not np.all(np.isfinite(motion.q))


def test_what_does_not_fit_is_named(dd_arm):
    ref = np.zeros((5, 2))
    undriven = replace(dd_arm, control=Control())
    with pytest.raises(ConfigError, match=r"control.law is 'measured' and no torque is given"):
        simulate(undriven, ref, 1e-3, np.zeros(2))
    with pytest.raises(DataError, match=r"ref has shape \(5, 3\), expected \(n_sample, 2\)"):
        simulate(dd_arm, np.zeros((5, 3)), 1e-3, np.zeros(2))
    with pytest.raises(DataError, match="torque has 4 samples and ref has 5; expected as many"):
        simulate(dd_arm, ref, 1e-3, np.zeros(2), torque=np.zeros((4, 2)))
    with pytest.raises(DataError, match=r"q0 has shape \(3,\), expected \(2,\)"):
        simulate(dd_arm, ref, 1e-3, np.zeros(3))
    with pytest.raises(DataError, match=r"dq0 has shape \(5, 2\), expected \(2,\)"):
        simulate(dd_arm, ref, 1e-3, np.zeros(2), ref)


def test_one_sample_is_a_motion_too(dd_arm):
    motion = simulate(dd_arm, np.array([[1.0, 0.0]]), 1e-3, np.zeros(2))
    assert motion.t.tolist() == [0.0] and motion.q.tolist() == [[0.0, 0.0]]
    np.testing.assert_allclose(mass_matrix(dd_arm, motion.q)[0] @ motion.ddq[0], [9.5, 0.0], rtol=0, atol=0.02)
