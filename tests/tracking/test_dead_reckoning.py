"""The kernel piece by piece: angles from positions, the moving average, Euler's two sums."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.chain import chain_of
from arm.kinematics import axis_frames, sensor_positions
from arm.model import Arm, Joint, Sensor
from tracking.dead_reckoning import (
    Reckoning,
    angles,
    carried_on,
    cosine_sine,
    direction,
    link_rotations,
    multiply,
    reckon,
    standing,
)
from tracking.layout import layout_of

FEW = settings(max_examples=50, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


def reckoning(arm, q0):
    layout = layout_of(arm)
    start = sensor_positions(arm, q0)[0]
    channels = 3 * len(arm.sensors)
    return Reckoning(
        chain_of(arm),
        layout.link,
        layout.position,
        layout.rotation,
        layout.pair,
        start,
        start[layout.pair[:, 1]] - start[layout.pair[:, 0]],
        np.array(q0, dtype=float),
        np.array(q0, dtype=float),
        np.zeros_like(start),
        np.zeros_like(start),
        np.zeros((4, channels)),
        np.zeros(channels),
    )


def random_chain(rng):
    """Return a chain of both kinds of joints with sensors anywhere on its links."""
    joints, sensors = [], []
    for i in range(int(rng.integers(1, 6))):
        slides = rng.random() < 0.4
        alpha, beta, offset = rng.uniform(-2.0, 2.0, 3).tolist()
        a, d = rng.uniform(-0.5, 0.5, 2).tolist()
        joints.append(Joint("prismatic" if slides else "revolute", alpha, a, d, beta, offset))
        for k in range(1 if slides else 2):
            at = rng.uniform(-0.1, 0.1, 3) + [0.3 * k, 0.1, 0.0]
            x, y, z = at.tolist()
            sensors.append(Sensor(f"s{i}{k}", i + 1, (x, y, z)))
    return Arm("chain", tuple(joints), sensors=tuple(sensors))


@FEW
@given(SEEDS)
def test_positions_give_the_angles_back(seed):
    rng = np.random.default_rng(seed)
    arm = random_chain(rng)
    n = arm.n_joint
    q0 = rng.uniform(-3.0, 3.0, n)
    state = reckoning(arm, q0)
    R, before, pair, facing = np.empty((n, 3, 3)), np.empty((n, 3, 3)), np.empty((n, 2)), np.empty((n, 2))
    standing(state, before, pair, facing)
    q = q0.copy()
    for _ in range(4):  # in steps of less than half a turn, so that whole turns are counted
        q = q + rng.uniform(-3.0, 3.0, n)
        state.moved[:] = sensor_positions(arm, q)[0] - state.start
        angles(state, before, pair, R, np.empty(3), facing)
        np.testing.assert_allclose(state.q, q, rtol=0, atol=1e-9)
        np.testing.assert_allclose(R, axis_frames(arm, q)[0, :, :3, :3], rtol=0, atol=1e-9)


@FEW
@given(SEEDS)
def test_readings_are_turned_by_the_angles_of_their_own_instant(seed):
    """Positions are a sample behind the readings, so the angles are carried on by one step."""
    rng = np.random.default_rng(seed)
    arm = random_chain(rng)
    n = arm.n_joint
    state = reckoning(arm, rng.uniform(-3.0, 3.0, n))
    state.q_before[:] = state.q - rng.uniform(-0.1, 0.1, n)
    (R, before), (pair, facing, ahead) = np.empty((2, n, 3, 3)), np.empty((3, n, 2))
    standing(state, before, pair, facing)
    carried_on(state, facing, ahead)
    link_rotations(ahead, before, R)
    q = 2 * state.q - state.q_before
    np.testing.assert_allclose(R, axis_frames(arm, q)[0, :, :3, :3], rtol=0, atol=1e-12)


def slide():
    """Return one joint that slides along x, its sensor's axes along the base's."""
    joint = Joint("prismatic", beta_rad=np.pi / 2)
    return Arm("slide", (joint,), (0.0, 0.0, 0.0), (Sensor("s", 1, rotation_rad=(0.0, -np.pi / 2, 0.0)),))


def reckoned(state, readings, dt, resting=False, first=0, decimation=1, phase=0):
    n = len(readings)
    q, moved = np.zeros((n, state.q.size)), np.zeros((n, len(state.start), 3))
    count = reckon(state, np.asarray(readings, dtype=float), dt, resting, first, decimation, phase, q, moved)
    return q[:count], moved[:count]


def test_the_moving_average_comes_first_and_then_two_sums():
    """Section 2.2: x(i+1) = x(i) + v(i) dt before v(i+1) = v(i) + a(i) dt, a the mean of the last four."""
    readings = np.zeros((9, 3))
    readings[:, 0] = [4.0, 0.0, 8.0, -4.0, 0.0, 0.0, 12.0, 0.0, 0.0]
    q, moved = reckoned(reckoning(slide(), np.zeros(1)), readings, 0.5)
    padded = np.concatenate([[0.0, 0.0, 0.0], readings[:, 0]])
    a = np.array([padded[k : k + 4].mean() for k in range(9)])
    v = np.concatenate([[0.0], np.cumsum(a) * 0.5])
    np.testing.assert_allclose(moved[:, 0, 0], np.cumsum(v[:-1]) * 0.5, rtol=0, atol=1e-14)
    np.testing.assert_allclose(q[:, 0], moved[:, 0, 0], rtol=0, atol=1e-14)


def test_constant_acceleration_is_summed_to_a_parabola():
    """After n samples Euler's sums hold a dt^2 n (n - 1) / 2: half a step more than a t^2 / 2."""
    a, dt = 2.0, 1e-3
    state = reckoning(slide(), np.zeros(1))
    state.recent[:, 0] = a
    q, _ = reckoned(state, np.tile([a, 0.0, 0.0], (1000, 1)), dt)
    t = dt * np.arange(1000)
    np.testing.assert_allclose(q[:, 0], a * t**2 / 2 + a * dt * t / 2, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("kind", "power"), [("bias", 2.0), ("white noise", 1.5)])
def test_drift_grows_faster_than_time(kind, power):
    """Four times as long: 16 times the error from a bias, 8 times that from white noise."""
    dt, n, rng = 1e-2, 1600, np.random.default_rng(0)
    errors = []
    for _ in range(400):
        readings = np.zeros((n, 3))
        readings[:, 0] = 0.02 * (rng.standard_normal() if kind == "bias" else rng.standard_normal(n))
        errors.append(reckoned(reckoning(slide(), np.zeros(1)), readings, dt)[0][[n // 4 - 1, n - 1], 0])
    early, late = np.sqrt(np.mean(np.square(errors), axis=0))
    assert late / early == pytest.approx(4.0**power, rel=0.15)


def test_while_it_rests_only_the_average_goes_on():
    state = reckoning(slide(), np.array([0.3]))
    q, moved = reckoned(state, [[1.0, 2.0, 3.0]] * 5, 0.1, resting=True)
    np.testing.assert_array_equal(q, 0.3)
    np.testing.assert_array_equal(moved, 0.0)
    np.testing.assert_array_equal(state.velocity, 0.0)
    np.testing.assert_array_equal(state.recent, [[1.0, 2.0, 3.0]] * 4)


def test_offsets_are_taken_off_and_gravity_is_added():
    arm = Arm("slide", slide().joints, (1.0, 2.0, -9.0), slide().sensors)
    state = reckoning(arm, np.zeros(1))
    state.offset[:] = [0.5, 0.0, 0.25]
    reading = [0.5 - 1.0, -2.0, 9.25]  # what it reads at rest
    state.recent[:] = reading
    _, moved = reckoned(state, [reading] * 10, 0.1)
    np.testing.assert_allclose(moved, 0.0, rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("first", "decimation", "phase", "due"), [(0, 4, 2, [2, 6]), (3, 4, 2, [3, 7]), (5, 3, 0, [1, 4, 7])]
)
def test_every_so_many_samples_make_a_frame(first, decimation, phase, due):
    state, every = reckoning(slide(), np.zeros(1)), reckoning(slide(), np.zeros(1))
    readings = np.random.default_rng(0).normal(size=(8, 3))
    q, _ = reckoned(state, readings, 0.1, first=first, decimation=decimation, phase=phase)
    whole, _ = reckoned(every, readings, 0.1, first=first)
    np.testing.assert_array_equal(q, whole[due])


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-4, 0.0029999, 0.0030001, 1.0, 3.0])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_what_stands_for_trigonometry_is_as_exact(size, sign):
    angle = sign * size
    assert cosine_sine(angle) == pytest.approx((np.cos(angle), np.sin(angle)), rel=0, abs=2.3e-16)
    assert direction(1.7 * np.cos(angle), 1.7 * np.sin(angle)) == pytest.approx(angle, rel=4e-16)


@FEW
@given(SEEDS)
def test_multiply_is_the_product(seed):
    A, B, out = np.random.default_rng(seed).normal(size=(3, 3, 3))
    multiply(A, B, out)
    np.testing.assert_allclose(out, A @ B, rtol=0, atol=1e-14)
