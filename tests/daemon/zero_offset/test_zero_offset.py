"""The biases that are found are those that the sensors have; an arm that moves has none to tell."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import draw_sensor_errors
from arm.model import Arm, Floats
from daemon.zero_offset.zero_offset import bias_at_rest
from limbcal.errors import NotIdentifiable

Limbd = Callable[..., Any]
RATE_HZ = 4000.0
ARM = load_arm("spatial-arm")
NOISE_M_S2 = 0.02


def scaled(arm: Arm, rng: np.random.Generator, highpass_hz: float = 0.0) -> Arm:
    sensors = [
        replace(sensor, scale=tuple(rng.uniform(0.9, 1.1, 3).tolist()), highpass_hz=highpass_hz)
        for sensor in arm.sensors
    ]
    return replace(arm, sensors=tuple(sensors))


def resting(arm: Arm, q: Floats, bias: Floats, rng: np.random.Generator) -> Floats:
    """Return what sensors with a bias read at a pose, for a second."""
    still = np.zeros((1, arm.n_joint))
    felt = np.array([sensor.scale for sensor in arm.sensors]) * specific_force(arm, q[None], still, still)[0]
    coupled = np.array([[sensor.highpass_hz > 0.0] for sensor in arm.sensors])
    level = np.where(coupled, 0.0, felt) + bias
    return level.ravel() + NOISE_M_S2 * rng.standard_normal((round(RATE_HZ), level.size))


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32), st.sampled_from([0.0, 0.1]))
def test_what_gravity_does_not_explain_is_bias(seed: int, highpass_hz: float) -> None:
    rng = np.random.default_rng(seed)
    arm, q = scaled(ARM, rng, highpass_hz), rng.uniform(-1.5, 1.5, ARM.n_joint)
    bias = rng.normal(0.0, 0.2, (len(arm.sensors), 3))
    found = bias_at_rest(arm, q, resting(arm, q, bias, rng), RATE_HZ)
    expected_std = NOISE_M_S2 / np.sqrt(RATE_HZ)
    np.testing.assert_allclose(found.bias_m_s2, bias, atol=6.0 * expected_std)
    assert np.median(found.std) == pytest.approx(expected_std, rel=0.4)


@pytest.mark.parametrize("change", ["step", "creep", "knock"])
def test_an_arm_that_moves_is_told_where(change: str) -> None:
    rng = np.random.default_rng(1)
    readings = resting(ARM, np.zeros(3), np.zeros((len(ARM.sensors), 3)), rng)
    t = np.arange(len(readings)) / RATE_HZ
    readings[:, 4] += {"step": 0.05 * (t > 0.7), "creep": 0.05 * t, "knock": 0.5 * (abs(t - 0.3) < 0.01)}[change]
    name = f"{ARM.sensors[1].name}y"
    with pytest.raises(NotIdentifiable, match=f"the arm moves: {name} is .* expected less than 0.011 m/s² while"):
        bias_at_rest(ARM, np.zeros(3), readings, RATE_HZ)


def test_the_virtual_arms_biases_are_found(limbd: Limbd, tmp_path: Path) -> None:
    seed = 4
    device = limbd("virtual", "--trials", "0", "--seed", str(seed), "--rate-hz", "16000", "--speed", "2", "--json")
    port = device.announcement()["port"]
    out = tmp_path / "zeroed.toml"
    zero = limbd("zero", "--port", port, "--arm", "dd-arm", "--seconds", "1", "--out", str(out), "--json")
    document = json.loads(zero.process.stdout.read())
    assert zero.wait() == 0
    assert device.stop() == 0
    arm = load_arm("dd-arm")
    true = draw_sensor_errors(arm, np.random.default_rng([seed, 2])).bias_m_s2
    assert (document["out"], document["seconds"], document["samples"]) == (str(out), 1.0, 16000)
    assert list(document["sensors"]) == [sensor.name for sensor in arm.sensors]
    found = np.array([sensor["bias_m_s2"] for sensor in document["sensors"].values()])
    std = np.array([sensor["std"] for sensor in document["sensors"].values()])
    assert np.abs(true).max() > 0.02
    np.testing.assert_allclose(found, true, atol=1e-3)
    assert (np.abs(found - true) < 8.0 * std).all()
    written = load_arm(out)
    np.testing.assert_array_equal([sensor.bias_m_s2 for sensor in written.sensors], found)
    unchanged = [replace(sensor, bias_m_s2=(0.0, 0.0, 0.0)) for sensor in written.sensors]
    assert replace(written, sensors=tuple(unchanged)) == arm
    assert f"written to {out}" in zero.said
    assert "±" in zero.said
