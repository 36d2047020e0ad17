"""Effects on readings, over blocks that follow each other: what comes before what, and the run's clock."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.effects.sensor_effects import SensorEffects
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Effect

RATE_HZ = 100.0
DRIFT = Effect("sensor_drift", {"x_m_s3": 0.5, "y_m_s3": 0.0, "z_m_s3": -0.25}, sensors=("s2",))
CLIP = Effect("sensor_clipping", {"level_m_s2": 1.0}, sensors=("s2", "s4"))
LATE = Effect("time_skew", {"delay_s": 0.02}, sensors=("s3",))
SWAY = Effect("base_motion", {"x_m_s2": 0.3, "y_m_s2": 0.4, "z_m_s2": 0.0, "frequency_hz": 5.0})


@pytest.fixture(scope="module")
def motion():
    rng = np.random.default_rng(0)
    return rng.normal(size=(60, 4, 3)), np.cumsum(rng.normal(scale=0.1, size=(60, 2)), axis=0)


def passed(effects, motion, *cuts):
    """Return readings without noise of a motion that comes in parts."""
    acting = SensorEffects(replace(load_arm("dd-arm"), effects=effects), RATE_HZ)
    parts = zip(np.split(motion[0], cuts), np.split(motion[1], cuts), strict=True)
    return np.vstack([acting.converted(acting.read(acting.felt(a.copy(), q))) for a, q in parts])


def test_without_effects_readings_are_what_is_felt(motion):
    np.testing.assert_array_equal(passed((), motion), motion[0])


def test_how_it_is_cut_into_blocks_makes_no_difference(motion):
    every = (DRIFT, CLIP, LATE, SWAY)
    np.testing.assert_allclose(passed(every, motion, 1, 2, 23), passed(every, motion), rtol=0, atol=1e-12)


def test_a_drift_grows_with_the_samples_over_their_rate(motion):
    more = passed((DRIFT,), motion, 25) - motion[0]
    np.testing.assert_allclose(more[:, 1], np.outer(np.arange(60) / 100.0, [0.5, 0.0, -0.25]), atol=1e-12)
    np.testing.assert_array_equal(np.delete(more, 1, axis=1), 0.0)


def test_a_range_clips_the_drift_too(motion):
    """Clipping comes last, whichever effect the file names first."""
    found, drifted = passed((CLIP, DRIFT), motion), passed((DRIFT,), motion)
    np.testing.assert_array_equal(found[:, [1, 3]], np.clip(drifted[:, [1, 3]], -1.0, 1.0))
    np.testing.assert_array_equal(found[:, [0, 2]], drifted[:, [0, 2]])


def test_a_late_sensor_feels_a_moving_base_late(motion):
    swayed, late = passed((SWAY,), motion), passed((SWAY, LATE), motion)
    np.testing.assert_allclose(late[2:, 2], swayed[:-2, 2], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(late[:, [0, 1, 3]], swayed[:, [0, 1, 3]])


def test_every_sensor_feels_the_base_in_its_own_axes(motion):
    arm = load_arm("dd-arm")
    turned = tuple(replace(sensor, rotation_rad=(0.1 * k, -0.2, 0.7)) for k, sensor in enumerate(arm.sensors))
    arm = replace(arm, sensors=turned, effects=(SWAY,))
    more = SensorEffects(arm, RATE_HZ).felt(motion[0].copy(), motion[1]) - motion[0]
    wave = np.sqrt(2.0) * np.sin(2.0 * np.pi * 5.0 * np.arange(60) / 100.0)
    felt = wave[:, None] * [0.3, 0.4, 0.0]
    for s, sensor in enumerate(turned):
        frames = axis_frames(arm, motion[1])[:, sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
        np.testing.assert_allclose(np.einsum("kij,kj->ki", frames, more[:, s]), felt, rtol=0, atol=1e-12)
