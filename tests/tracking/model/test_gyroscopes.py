"""Gyroscopes beside accelerometers: what they should read, and what they make of a motion that is known."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.gyroscope import angular_velocity
from arm.kinematics import rotation_from_rpy, rpy_from_rotation
from arm.model import Arm, Floats, Gyroscope
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.expected_readings import observe, room_of
from tracking.model.first_rest import resting
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.noise import noise_of
from tracking.model.observation import channels_alike, observation_of, rms_alike
from tracking.model.readings import Readings, ReadingsBuilder
from tracking.smoother.self_calibration import calibrate_sensors
from tracking.smoother.smoothed_frames import smooth_motion

RATE_HZ, SECONDS = 200.0, 12.0
#: Noise of a sample and offsets [m/s^2, rad/s].
NOISE, RATE_NOISE, RATE_OFFSET = 0.02, 0.003, 0.02
STEP = 1e-6
ARMS = ["dd-arm", "dd-arm-vertical", "spatial-arm"]


def one_a_link(name: str) -> Arm:
    """Return an arm with the outermost sensor of each link."""
    arm = load_arm(name)
    return replace(arm, sensors=tuple({sensor.joint: sensor for sensor in arm.sensors}.values()), tip=None)


def with_gyros(arm: Arm) -> Arm:
    return arm.with_gyroscopes([sensor.name for sensor in arm.sensors])


def swinging(n_joint: int, seed: int) -> tuple[Floats, Floats, Floats]:
    """Return a second's rest and a motion of some sines, without a jump: q, dq, ddq (n, n_joint)."""
    rng, t = np.random.default_rng(seed), np.arange(round(SECONDS * RATE_HZ)) / RATE_HZ
    s = np.clip((t - 1.0) / 2.0, 0.0, 1.0)[:, None]
    window = s**3 * (10 - 15 * s + 6 * s**2), 15 * s**2 * (1 - s) ** 2, 15 * s * (1 - s) * (1 - 2 * s)
    w, size, phase = (
        2 * np.pi * rng.uniform(0.2, 1.0, (3, n_joint)),
        rng.uniform(0.1, 0.4, (3, n_joint)),
        rng.normal(size=(3, n_joint)),
    )
    angle = w * t[:, None, None] + phase
    x = (size * np.sin(angle)).sum(1), (size * w * np.cos(angle)).sum(1), -(size * w**2 * np.sin(angle)).sum(1)
    return (
        window[0] * x[0],
        window[1] * x[0] + window[0] * x[1],
        window[2] * x[0] + 2 * window[1] * x[1] + window[0] * x[2],
    )


def read(arm: Arm, seed: int) -> tuple[Floats, Floats]:
    """Return what an arm's accelerometers and gyroscopes read of a motion, (n, n_channel), and its angles."""
    rng = np.random.default_rng([seed, 1])
    q, dq, ddq = swinging(arm.n_joint, seed)
    a, w = specific_force(arm, q, dq, ddq).reshape(len(q), -1), angular_velocity(arm, q, dq).reshape(len(q), -1)
    scale = [sensor.gyroscope.scale for sensor in arm.sensors if sensor.gyroscope is not None]
    w = w * np.ravel(scale) + RATE_OFFSET * rng.standard_normal(w.shape[1])
    a = a + NOISE * rng.standard_normal(a.shape[1])
    return np.hstack([a + NOISE * rng.standard_normal(a.shape), w + RATE_NOISE * rng.standard_normal(w.shape)]), q


def readings_of(arm: Arm, values: Floats) -> Readings:
    builder = ReadingsBuilder(RATE_HZ, arm.n_channel, RATE_HZ, 3 * len(arm.gyroscopes))
    builder.push(values[:, : arm.n_channel])
    return builder.done()


@pytest.mark.parametrize("name", ARMS)
def test_a_gyroscope_should_read_what_an_ideal_one_does_and_slopes_are_differences(name: str) -> None:
    """With its scale, turn and offset in the state."""
    arm, rng = load_arm(name), np.random.default_rng(2)
    arm = arm.with_gyroscopes([arm.sensors[0].name, arm.sensors[-1].name])
    of, size = observation_of(arm, mountings=True, base=True, lack=True)
    x, n, first = 0.02 * rng.normal(size=size), arm.n_joint, 3 * len(arm.sensors)
    x[: 3 * n] = rng.normal(size=3 * n)
    turns = np.concatenate([np.arange(k + 3, k + 6) for k in np.unique(of.mounting_column)])
    x[turns] = 0.0

    def seen(at: Floats) -> tuple[Floats, Floats]:
        reading, slope = np.empty(arm.n_channel), np.zeros((arm.n_channel, size))
        observe(of, room_of(n), at, reading, slope)
        return reading, slope

    reading, slope = seen(x)
    scale = np.concatenate([1.0 + x[k : k + 3] for k in of.gyro_scale_column[of.turning]])
    ideal = angular_velocity(arm, x[None, : 3 * n : 3], x[None, 1 : 3 * n : 3]).ravel()
    offset = x[3 * n : 3 * n + arm.n_channel] + x[of.lack_column : of.lack_column + arm.n_channel]
    np.testing.assert_allclose(reading[first:], scale * ideal + offset[first:], rtol=1e-12, atol=1e-12)
    for column in range(size):
        step = np.zeros(size)
        step[column] = STEP
        expected = (seen(x + step)[0] - seen(x - step)[0]) / (2.0 * STEP)
        np.testing.assert_allclose(slope[first:, column], expected[first:], atol=1e-7)


def test_a_gyroscope_turns_with_its_housing() -> None:
    arm = one_a_link("spatial-arm")
    of, size = observation_of(with_gyros(arm), mountings=True)
    x, turn = np.zeros(size), np.array([0.1, -0.2, 0.3])
    x[: 3 * arm.n_joint] = np.random.default_rng(3).normal(size=3 * arm.n_joint)
    x[of.mounting_column[0] + 3 : of.mounting_column[0] + 6] = turn
    reading, slope = np.empty(with_gyros(arm).n_channel), np.zeros((with_gyros(arm).n_channel, size))
    observe(of, room_of(arm.n_joint), x, reading, slope)
    angle = np.linalg.norm(turn)
    K = np.cross(np.eye(3), turn / angle)
    R = rotation_from_rpy(*arm.sensors[0].rotation_rad) @ (
        np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    )
    turned = replace(arm.sensors[0], rotation_rad=tuple(rpy_from_rotation(R)))
    moved = with_gyros(replace(arm, sensors=(turned, *arm.sensors[1:])))
    expected = angular_velocity(moved, x[None, : 3 * arm.n_joint : 3], x[None, 1 : 3 * arm.n_joint : 3])[0]
    np.testing.assert_allclose(reading[3 * len(arm.sensors) :], expected.ravel(), atol=1e-12)
    for column in range(of.mounting_column[0] + 3, of.mounting_column[0] + 6):  # also where it is turned
        sides = []
        for step in (STEP, -STEP):
            at, beside = x.copy(), reading.copy()
            at[column] += step
            observe(of, room_of(arm.n_joint), at, beside, np.zeros_like(slope))
            sides.append(beside)
        np.testing.assert_allclose(slope[:, column], (sides[0] - sides[1]) / (2.0 * STEP), atol=1e-6)


@pytest.mark.parametrize("name", ARMS)
def test_the_smoother_is_right_with_them_and_its_claims_hold(name: str) -> None:
    arm = with_gyros(one_a_link(name))
    values, q = read(arm, 0)
    error = {}
    for one in (arm, arm.with_gyroscopes(())):
        found = smooth_motion(one, readings_of(one, values), q[0])
        off = np.abs(found.frames.q - q)
        error[one.n_channel] = off.mean(axis=0)
        assert found.smoothed.is_exact
        assert (off < 3.0 * found.frames.q_std).mean() >= 0.99
    assert (error[arm.n_channel] < error[3 * len(arm.sensors)]).all()


def test_the_live_filter_is_right_with_them() -> None:
    arm = with_gyros(one_a_link("dd-arm-vertical"))
    values, q = read(arm, 1)
    error = {}
    for one in (arm, arm.with_gyroscopes(())):
        tracker = KalmanTracker(one, RATE_HZ, q[0], RATE_HZ)
        frames = tracker.push(0, values[:, : one.n_channel])[0] + tracker.flush()[0]
        off = np.abs(np.vstack([block.q for block in frames]) - q)
        error[one.n_channel] = off.mean(axis=0)
        assert (off < 3.0 * np.vstack([block.q_std for block in frames])).mean() >= 0.99
        assert np.concatenate([block.points for block in frames]).shape == (len(q), len(arm.sensors), 3)
    assert (error[arm.n_channel] < error[3 * len(arm.sensors)]).all()


def test_scale_and_offset_of_a_gyroscope_are_found() -> None:
    arm = with_gyros(one_a_link("dd-arm-vertical"))
    scaled = Gyroscope((1.0, 1.0, 1.02))
    values, q = read(replace(arm, sensors=(replace(arm.sensors[0], gyroscope=scaled), *arm.sensors[1:])), 2)
    found = calibrate_sensors(arm, [readings_of(arm, values)], q[0], MountingPrior())
    of_z = {
        one.name: one for one in found.estimates if one.sensor == arm.sensors[0].name and one.name.endswith("_z")
    }
    scale, bias = of_z["gyro_scale_z"], of_z["gyro_bias_z"]
    assert scale.revealed and bias.revealed
    assert abs(scale.value - 1.02) < 4.0 * scale.std and scale.std < 0.005
    true = values[: round(0.9 * RATE_HZ), 3 * len(arm.sensors) + 2].mean()
    assert abs(bias.value - true) < 1e-3
    kept = found.arm.sensors[0].gyroscope
    assert kept is not None and kept.scale[2] == scale.value and kept.bias_rad_s[2] == bias.value
    assert f"{arm.sensors[0].name} gyro_scale_z" in found.arm.sensor_covariance.parameters
    of, size = observation_of(found.arm, True)
    P = start_state(found.arm, of, size, resting(values[:50].mean(axis=0)), q[0], True, MountingPrior())[1]
    column = of.gyro_scale_column[len(arm.sensors)] + 2
    assert np.sqrt(P[column, column]) == pytest.approx(scale.std)


def test_kinds_of_sensors_have_noise_of_their_own() -> None:
    of, size = observation_of(with_gyros(one_a_link("dd-arm")), lack=True)
    assert channels_alike(of) == [slice(0, 6), slice(6, 12)]
    values = np.tile([3.0] * 6 + [0.1] * 6, (5, 1))
    np.testing.assert_allclose(rms_alike(of, values), values[0])


def test_a_gyroscope_has_a_floor_of_noise_of_its_own() -> None:
    quiet = np.random.default_rng(0).standard_normal((1000, 6)) * 1e-9
    least = noise_of(quiet, RATE_HZ, 3).of_mean(1)
    assert (least[3:] < 0.1 * least[:3]).all()


def test_at_rest_a_gyroscope_reads_its_offset() -> None:
    """What the others read of gravity says nothing of how large it may be."""
    arm = with_gyros(one_a_link("dd-arm-vertical"))
    of, size = observation_of(arm)
    first = np.concatenate([specific_force(arm, *np.zeros((3, 1, 2))).ravel(), np.full(6, 0.05)])
    x, P = start_state(arm, of, size, resting(first), np.zeros(2), True, MountingPrior())
    std = np.sqrt(np.diag(P))[6 : 6 + arm.n_channel]
    assert (x[6 : 6 + arm.n_channel] == 0.0).all()
    np.testing.assert_allclose(std, [0.02] * 6 + [0.1] * 6)
