"""What sensors should read in a state, and its slopes, against the accelerometer's own formula."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.accelerometer import specific_force
from arm.kinematics import rotation_from_rpy, rpy_from_rotation
from tracking.model.expected_readings import add_information, observe, room_of
from tracking.model.observation import MOUNTING, observation_of

ARMS = ["dd_arm", "spatial", "sliding", "branching"]
STEP = 1e-5


def seen(arm, x, mountings=False):
    of, size = observation_of(arm, mountings)
    assert x.shape == (size,)
    reading, slope = np.empty(3 * len(arm.sensors)), np.zeros((3 * len(arm.sensors), size))
    observe(of, room_of(arm.n_joint), x, reading, slope)
    return reading, slope


def state(arm, mountings=False, seed=0, turn=0.0):
    """Return a state with everything in it, and its joint motion and offsets."""
    of, size = observation_of(arm, mountings)
    rng, n = np.random.default_rng(seed), arm.n_joint
    x = np.zeros(size)
    x[: 3 * n] = rng.normal(size=3 * n)
    x[3 * n : 3 * n + 3 * len(arm.sensors)] = rng.normal(size=3 * len(arm.sensors))
    lengths = of.length_column[of.length_column >= 0]
    x[lengths] = 0.1 * rng.normal(size=len(lengths))
    for first in of.mounting_column[of.mounting_column >= 0]:
        x[first : first + MOUNTING] = rng.normal(size=MOUNTING) * np.repeat([0.05, turn, 0.02], 3)
    return of, x


def as_mounted(arm, of, x):
    """Return the arm whose file says what a state says of lengths, scales, turns and places."""
    joints = [
        replace(
            joint,
            a_m=joint.a_m + (x[a] if a >= 0 else 0.0),
            d_m=joint.d_m + (x[d] if d >= 0 else 0.0),
        )
        for joint, (a, d) in zip(arm.joints, of.length_column, strict=True)
    ]
    sensors = []
    for sensor, first in zip(arm.sensors, of.mounting_column, strict=True):
        scale, turn, place = x[first : first + MOUNTING].reshape(3, 3) if first >= 0 else np.zeros((3, 3))
        rotation = rotation_from_rpy(*sensor.rotation_rad) @ Rotation.from_rotvec(turn).as_matrix()
        sensors.append(
            replace(
                sensor,
                position_m=tuple(np.add(sensor.position_m, place)),
                rotation_rad=tuple(rpy_from_rotation(rotation)),
                scale=tuple(np.add(sensor.scale, scale)),
            )
        )
    return replace(arm, joints=tuple(joints), sensors=tuple(sensors))


def read_by(arm, x):
    """Return what the accelerometer's formula, the sensors' scale and the state's offsets give."""
    n = arm.n_joint
    force = specific_force(arm, x[None, : 3 * n : 3], x[None, 1 : 3 * n : 3], x[None, 2 : 3 * n : 3])[0]
    scaled = force * np.array([sensor.scale for sensor in arm.sensors])
    return scaled.ravel() + x[3 * n : 3 * n + scaled.size]


def differences(arm, x, mountings):
    columns = []
    for c in range(x.size):
        sides = []
        for step in (STEP, -STEP):
            moved = x.copy()
            moved[c] += step
            sides.append(seen(arm, moved, mountings)[0])
        columns.append((sides[0] - sides[1]) / (2.0 * STEP))
    return np.column_stack(columns)


def coupled(arm):
    return replace(arm, sensors=tuple(replace(s, highpass_hz=0.2, scale=(1.1, 0.9, 1.0)) for s in arm.sensors))


@pytest.fixture(params=ARMS)
def arm(request):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize("seed", range(5))
def test_readings_are_specific_force_scaled_and_offset(arm, seed):
    scaled = replace(arm, sensors=tuple(replace(s, scale=(1.2, 0.8, 1.0)) for s in arm.sensors))
    of, x = state(scaled, seed=seed)
    lengths = of.length_column[of.length_column >= 0]
    x[lengths] = 0.0
    np.testing.assert_allclose(seen(scaled, x)[0], read_by(scaled, x), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("turn", [0.0, 0.02, 1.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_mounting_is_that_of_an_arm_so_mounted(arm, turn, seed):
    """Lengths, scales, turns of any size and places of the state say what the arm file would."""
    of, x = state(arm, True, seed, turn)
    np.testing.assert_allclose(seen(arm, x, True)[0], read_by(as_mounted(arm, of, x), x), rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize(
    ("mountings", "turn"), [(False, 0.0), (True, 0.0), (True, 1e-6), (True, 0.1), (True, 1.0)]
)
@pytest.mark.parametrize("seed", range(3))
def test_slopes_are_those_of_central_differences(arm, mountings, turn, seed):
    """By motion, offsets, lengths, scales, turns of any size and places; AC coupling adds none."""
    arm = coupled(arm)
    _, x = state(arm, mountings, seed, turn)
    reading, slope = seen(arm, x, mountings)
    expected = differences(arm, x, mountings)
    np.testing.assert_allclose(slope, expected, rtol=1e-6, atol=1e-8 * max(10.0, np.abs(reading).max()))


@pytest.mark.parametrize("mountings", [False, True])
def test_nothing_is_written_but_the_columns_a_channel_depends_on(arm, mountings):
    arm = coupled(arm)
    of, size = observation_of(arm, mountings)
    slope = np.full((3 * len(arm.sensors), size), np.nan)
    room, reading = room_of(arm.n_joint), np.empty(3 * len(arm.sensors))
    for seed in range(3):
        observe(of, room, state(arm, mountings, seed)[1], reading, slope)
    written = np.zeros(slope.shape, dtype=bool)
    for channel, (columns, count) in enumerate(zip(of.columns, of.n_column, strict=True)):
        assert len(set(columns[:count])) == count
        written[channel, columns[:count]] = True
    np.testing.assert_array_equal(~np.isnan(slope), written)


def test_each_reading_tells_of_the_accelerations_of_the_joints_before_it(arm):
    """The sum of what each tells: its slopes by them, squared, over its variance; added to what was known."""
    of, x = state(arm, seed=4)
    n = arm.n_joint
    slope = seen(arm, x)[1]
    variance = np.linspace(0.5, 2.0, len(slope))
    A = np.eye(n)
    add_information(of, variance, slope, A)
    by_acceleration = slope[:, 2 : 3 * n : 3]
    beyond = np.arange(n) > np.repeat([sensor.joint - 1 for sensor in arm.sensors], 3)[:, None]
    assert (by_acceleration[beyond] == 0.0).all() and beyond.any()
    expected = np.eye(n) + (by_acceleration.T / variance) @ by_acceleration
    np.testing.assert_allclose(A, expected, rtol=1e-12, atol=1e-12)


def with_base_and_lack(arm, seed=0):
    of, size = observation_of(arm, mountings=True, base=True, lack=True)
    x = np.zeros(size)
    own = state(arm, True, seed, 0.1)[1]
    x[: own.size] = own
    x[own.size :] = np.random.default_rng(seed).normal(size=size - own.size)
    return of, x


def read_with(of, x):
    reading, slope = np.empty(3 * of.link.size), np.zeros((3 * of.link.size, x.size))
    observe(of, room_of(of.chain.revolute.size), x, reading, slope)
    return reading, slope


def test_a_base_that_accelerates_is_felt_as_gravity_the_other_way(arm):
    """And what the model lacks is added to the reading."""
    of, x = with_base_and_lack(arm)
    b, lack = x[of.base_column : of.base_column + 3], x[of.lack_column :]
    plain, own = observation_of(arm, mountings=True)
    leaning = replace(arm, gravity_m_s2=tuple(np.subtract(arm.gravity_m_s2, b)))
    still = x[:own].copy()
    expected = read_with(observation_of(leaning, mountings=True)[0], still)[0] + lack
    np.testing.assert_allclose(read_with(of, x)[0], expected, rtol=1e-12)
    assert plain.base_column < 0 and plain.lack_column < 0


@pytest.mark.parametrize("seed", range(3))
def test_slopes_by_base_and_lack_are_those_of_central_differences(arm, seed):
    of, x = with_base_and_lack(arm, seed)
    _, slope = read_with(of, x)
    for column in range(of.base_column, x.size):
        step = STEP * (np.arange(x.size) == column)
        expected = (read_with(of, x + step)[0] - read_with(of, x - step)[0]) / (2.0 * STEP)
        np.testing.assert_allclose(slope[:, column], expected, rtol=1e-6, atol=1e-8)
        touched = [column in of.columns[c, : of.n_column[c]] for c in range(len(slope))]
        assert not slope[~np.array(touched), column].any()


@pytest.mark.parametrize("seed", range(3))
def test_a_base_says_nothing_of_gains(arm, seed):
    """Slopes by scales, and by places, are those of a base that stands."""
    of, x = with_base_and_lack(arm, seed)
    standing = x.copy()
    standing[of.base_column : of.base_column + 3] = 0.0
    columns = (of.mounting_column[:, None] + [0, 1, 2, 6, 7, 8]).ravel()
    expected = read_with(of, standing)[1][:, columns]
    np.testing.assert_allclose(read_with(of, x)[1][:, columns], expected, rtol=1e-10, atol=1e-10)
