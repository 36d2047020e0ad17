"""Frames taken in in strides give what they give one at a time, to the bit."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench, Sensors, draw_sensor_errors, motions
from tracking.kalman.batch_filter import BatchFilter
from tracking.kalman.live_filter import LiveFilter
from tracking.model.decimation import Decimator
from tracking.model.noise import noise_of
from tracking.model.zero_velocity import window_frames

RATE_HZ, FACTOR = 4000.0, 4


@pytest.fixture(scope="module")
def frames():
    """Return a motion from rest to rest with a hole, a push that no motion explains, and another long hole."""
    arm = load_arm("dd-arm")
    rng = np.random.default_rng(3)
    sensors = Sensors(arm, draw_sensor_errors(arm, rng), RATE_HZ, rng)
    motion = next(iter(motions(arm, Bench(rate_hz=RATE_HZ, learning=1, evaluating=0), 3)))
    readings = sensors.counts(motion) * 1.5e-3
    made = Decimator(FACTOR, readings.shape[1]).push(readings)
    made[1500:1540] = np.nan
    made[2000] += 30.0
    made[2500:2900] = np.nan
    return arm, made, noise_of(readings[:1000], RATE_HZ)


@pytest.mark.parametrize("size", [1, 7, 10, 640])
def test_strides_give_what_steps_give(frames, size):
    arm, readings, noise = frames
    dt_s = FACTOR / RATE_HZ
    cell, n_cell = window_frames(dt_s)
    first = readings[: cell * n_cell]
    q = np.zeros(arm.n_joint)
    one, many = (kind(arm, q, True, first, noise, FACTOR, dt_s) for kind in (LiveFilter, BatchFilter))
    known = 3 * arm.n_joint + readings.shape[1]
    rested = []
    for begin in range(0, len(readings), size):
        piece = readings[begin : begin + size]
        course = many.follow(piece)
        for k, reading in enumerate(piece):
            assert one.step(reading) == course.still[k]
            assert one.resting == course.resting[k]
            rested.append(one.resting)
            np.testing.assert_array_equal(course.states[k], one.x[:known])
            np.testing.assert_array_equal(course.variances[k], one.angle_variance)
    assert one.consistency() == many.consistency()
    assert any(rested) and not all(rested)
