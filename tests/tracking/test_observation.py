"""What sensors should read in a state, and its slopes, against the accelerometer's own formula."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.accelerometer import specific_force
from arm.kinematics import rotation_from_rpy, rpy_from_rotation
from tracking.expected_readings import add_information, observe, room_of
from tracking.observation import MOUNTING, MOUNTING_NAMES, observation_of

ARMS = ["dd_arm", "spatial", "sliding"]
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


@pytest.mark.parametrize("mountings", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_slopes_are_those_of_central_differences(arm, mountings, seed):
    """By motion, offsets, lengths, scales, turns and places; of what AC coupling adds no reading depends."""
    arm = coupled(arm)
    _, x = state(arm, mountings, seed)
    reading, slope = seen(arm, x, mountings)
    expected = differences(arm, x, mountings)
    np.testing.assert_allclose(slope, expected, rtol=1e-6, atol=1e-8 * max(10.0, np.abs(reading).max()))


def test_slopes_by_a_small_turn_are_off_by_no_more_than_it(spatial):
    """They are those of a turn that is added on top; all others are exact."""
    of, x = state(spatial, True, 1, turn=0.01)
    reading, slope = seen(spatial, x, True)
    expected = differences(spatial, x, True)
    turns = np.concatenate([np.arange(first + 3, first + 6) for first in of.mounting_column])
    others = np.setdiff1d(np.arange(x.size), turns)
    np.testing.assert_allclose(slope[:, others], expected[:, others], rtol=1e-6, atol=1e-6)
    largest = max(np.linalg.norm(x[first + 3 : first + 6]) for first in of.mounting_column)
    assert np.abs(slope - expected)[:, turns].max() < largest * np.abs(reading).max()


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


def test_the_state_is_laid_out_as_it_says(dd_arm, sliding):
    of, size = observation_of(dd_arm)
    assert size == 6 + 12 + 2  # of link 1 its length a, of joint 2 the shift d
    np.testing.assert_array_equal(of.length_column, [[18, -1], [-1, 19]])
    of, size = observation_of(sliding)
    assert size == 6 + 9 + 1  # a sliding joint's shift is its own zero
    np.testing.assert_array_equal(of.length_column, [[15, -1], [-1, -1]])
    of, size = observation_of(coupled(dd_arm), True)
    assert size == 6 + 12 + 2 + 4 * (3 + 1) + 4 * MOUNTING
    columns = np.concatenate(
        [
            of.length_column[of.length_column >= 0],
            *(np.arange(s, s + 3) for s in of.settled_column),
            of.corner_column,
            *(np.arange(m, m + MOUNTING) for m in of.mounting_column),
        ]
    )
    np.testing.assert_array_equal(np.sort(columns), np.arange(18, size))
    np.testing.assert_allclose(of.corner, 2 * np.pi * 0.2)


def test_the_names_of_a_mounting_are_in_the_order_of_its_columns():
    assert len(MOUNTING_NAMES) == MOUNTING == 9
    assert MOUNTING_NAMES[:4] == ("scale_x", "scale_y", "scale_z", "turn_x") and MOUNTING_NAMES[8] == "place_z"


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
