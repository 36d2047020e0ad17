"""The kernel piece by piece: the moving average, Euler's two sums."""

import numpy as np
import pytest

from arm.model import Arm, Joint, Sensor
from tracking.dead_reckoning.integration import reckon
from tracking.dead_reckoning.integration_state import reckoning_of


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
    q, moved = reckoned(reckoning_of(slide(), np.zeros(1)), readings, 0.5)
    padded = np.concatenate([[0.0, 0.0, 0.0], readings[:, 0]])
    a = np.array([padded[k : k + 4].mean() for k in range(9)])
    v = np.concatenate([[0.0], np.cumsum(a) * 0.5])
    np.testing.assert_allclose(moved[:, 0, 0], np.cumsum(v[:-1]) * 0.5, rtol=0, atol=1e-14)
    np.testing.assert_allclose(q[:, 0], moved[:, 0, 0], rtol=0, atol=1e-14)


def test_constant_acceleration_is_summed_to_a_parabola():
    """After n samples Euler's sums hold a dt^2 n (n - 1) / 2: half a step more than a t^2 / 2."""
    a, dt = 2.0, 1e-3
    state = reckoning_of(slide(), np.zeros(1))
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
        errors.append(reckoned(reckoning_of(slide(), np.zeros(1)), readings, dt)[0][[n // 4 - 1, n - 1], 0])
    early, late = np.sqrt(np.mean(np.square(errors), axis=0))
    assert late / early == pytest.approx(4.0**power, rel=0.15)


def test_while_it_rests_only_the_average_goes_on():
    state = reckoning_of(slide(), np.array([0.3]))
    q, moved = reckoned(state, [[1.0, 2.0, 3.0]] * 5, 0.1, resting=True)
    np.testing.assert_array_equal(q, 0.3)
    np.testing.assert_array_equal(moved, 0.0)
    np.testing.assert_array_equal(state.velocity, 0.0)
    np.testing.assert_array_equal(state.recent, [[1.0, 2.0, 3.0]] * 4)


def test_offsets_are_taken_off_and_gravity_is_added():
    arm = Arm("slide", slide().joints, (1.0, 2.0, -9.0), slide().sensors)
    state = reckoning_of(arm, np.zeros(1))
    state.offset[:] = [0.5, 0.0, 0.25]
    reading = [0.5 - 1.0, -2.0, 9.25]  # what it reads at rest
    state.recent[:] = reading
    _, moved = reckoned(state, [reading] * 10, 0.1)
    np.testing.assert_allclose(moved, 0.0, rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("first", "decimation", "phase", "due"), [(0, 4, 2, [2, 6]), (3, 4, 2, [3, 7]), (5, 3, 0, [1, 4, 7])]
)
def test_every_so_many_samples_make_a_frame(first, decimation, phase, due):
    state, every = reckoning_of(slide(), np.zeros(1)), reckoning_of(slide(), np.zeros(1))
    readings = np.random.default_rng(0).normal(size=(8, 3))
    q, _ = reckoned(state, readings, 0.1, first=first, decimation=decimation, phase=phase)
    whole, _ = reckoned(every, readings, 0.1, first=first)
    np.testing.assert_array_equal(q, whole[due])
