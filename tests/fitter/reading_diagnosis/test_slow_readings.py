"""Readings of a hundred hertz, in files whose clocks each start at zero: what contradicts a rigid arm is named."""

from collections.abc import Callable

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Floats
from fitter.data.raw import RawRun
from fitter.reading_diagnosis.rigidity import diagnose_sensors

RATE_HZ, SECONDS, REST_S, FINER = 100.0, 5.0, 1.0, 20
Touch = Callable[[Arm, Floats, Floats, Floats, np.random.Generator], Floats]


@pytest.fixture(scope="module")
def arm() -> Arm:
    return load_arm("dd-arm-vertical")


def trial(arm: Arm, seed: int, touch: Touch) -> RawRun:
    """Return readings of a swing from a rest on; derivatives are taken on a finer grid."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, SECONDS, 1.0 / RATE_HZ / FINER)
    since = np.maximum(t - REST_S, 0.0)[:, None]
    rates, amplitudes = 2.0 * np.pi * rng.uniform(0.3, 1.0, 2), rng.uniform(0.4, 0.8, 2)
    q = (1.0 - np.exp(-(since**3))) * amplitudes * np.sin(rates * since)
    dq = np.gradient(q, t, axis=0)
    felt = specific_force(arm, q, dq, np.gradient(dq, t, axis=0)).reshape(len(t), -1)
    felt = touch(arm, t, q, felt, rng)[::FINER]
    return RawRun(f"{seed}", RATE_HZ, t[::FINER], felt + 0.02 * rng.standard_normal(felt.shape))


def diagnosed(arm: Arm, touch: Touch, each: int = 1):
    """Diagnose as many trials to learn from as to judge by."""
    runs = [trial(arm, seed, touch) for seed in range(2 * each)]
    return diagnose_sensors(arm, runs[:each], runs[each:])


def as_it_is(_arm, _t, _q, felt, _rng):
    return felt


def late(_arm, t, _q, felt, _rng):
    felt[:, 9:] = np.column_stack([np.interp(t - 0.007, t, column) for column in felt[:, 9:].T])
    return felt


def shaken(arm, t, q, felt, rng):
    """Return readings on a base whose acceleration wanders, .3 m/s^2 along each axis, over a tenth of a second."""
    kept = np.exp(-1.0 / (RATE_HZ * FINER * 0.1))
    base = 0.3 * rng.standard_normal((len(t), 3))
    for k in range(1, len(base)):
        base[k] = kept * base[k - 1] + np.sqrt(1.0 - kept**2) * base[k]
    frames = axis_frames(arm, q)
    for s, sensor in enumerate(arm.sensors):
        R = frames[:, sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
        felt[:, 3 * s : 3 * s + 3] += np.einsum("kij,ki->kj", R, base)
    return felt


def test_a_rigid_arm_is_not_contradicted(arm):
    assert diagnosed(arm, as_it_is, each=2).verdict == "none"


def test_a_late_sensor_is_named(arm):
    found = diagnosed(arm, late)
    (cause,) = found.causes
    assert (found.verdict, cause.effect, cause.sensors) == ("named", "time_skew", (arm.sensors[3].name,))
    delay = cause.parameters["delay_s"]
    assert delay.value == pytest.approx(0.007, abs=2.0 * delay.std)


def test_a_base_that_shakes_in_any_way_is_named(arm):
    found = diagnosed(arm, shaken)
    (cause,) = found.causes
    assert (found.verdict, cause.effect, cause.sensors) == ("named", "base_motion", ())
    assert found.gain > 0.95
    across = [cause.parameters[f"{axis}_m_s2"] for axis in "yz"]  # along gravity a base is an arm that leans
    assert [one.value for one in across] == pytest.approx([0.3, 0.3], rel=0.25)
    assert not found.arm.effects  # in any way is no effect of an arm file
