"""What `limbd zero` writes, says and refuses, of readings that the test makes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from daemon.__main__ import main
from daemon.config.config import load_setup
from daemon.zero_offset import zero_offset as module
from daemon.zero_offset.zero_offset import bias_at_rest, zero_sensors
from limbcal.errors import NotIdentifiable

ARM = load_arm("dd-arm")
G = 9.80665
RATE_HZ = 1000.0


def readings(bias: np.ndarray, seconds: float = 1.0) -> np.ndarray:
    """Return what level sensors read, with a triangle of 0.04 m/s^2 about it, which cells of 0.1 s average out."""
    level = np.tile([0.0, 0.0, G], 4) + bias
    wave = 0.01 * np.array([0, 1, 2, 1, 0, -1, -2, -1, 0, 0])
    return level + np.tile(wave, round(100 * seconds))[:, None]


def measured(monkeypatch: pytest.MonkeyPatch, bias: np.ndarray) -> None:
    monkeypatch.setattr(module, "sample_burst", lambda *_: (RATE_HZ, readings(bias)))


def test_biases_go_into_the_arm_s_file_to_a_millionth(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    bias = 0.1 * np.arange(12) + 4e-8
    measured(monkeypatch, bias)
    setup = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}})
    out = tmp_path / "zeroed.toml"
    document = zero_sensors(setup, 1.0, out)
    assert (document["out"], document["seconds"], document["samples"]) == (str(out), 1.0, 1000)
    written = np.array([sensor.bias_m_s2 for sensor in load_arm(out).sensors]).ravel()
    np.testing.assert_allclose(written, 0.1 * np.arange(12), atol=1e-9)
    again = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": str(out)}})
    assert zero_sensors(again, 1.0, None)["out"] == str(out)


@pytest.mark.parametrize(("off", "warned"), [(2.9, False), (-3.1, True)])
def test_more_than_three_metres_per_second_squared_are_no_bias(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str], off: float, warned: bool
) -> None:
    bias = np.zeros(12)
    bias[4] = off
    measured(monkeypatch, bias)
    setup = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}})
    zero_sensors(setup, 1.0, tmp_path / "z.toml")
    captured = capsys.readouterr()
    text = " ".join((captured.out + captured.err).split())
    assert ("warning: s2 is off by 3.1 m/s², more than accelerometers are" in text) == warned
    assert "bias, m/s²" in text and "written to" in text


def test_a_sensor_is_called_what_the_arms_file_calls_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first, *others = ARM.sensors
    save_arm(replace(ARM, sensors=(replace(first, name="s[old]"), *others)), tmp_path / "arm.toml")
    measured(monkeypatch, np.zeros(12))
    setup = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": str(tmp_path / "arm.toml")}})
    zero_sensors(setup, 1.0, None)
    assert "s[old]" in capsys.readouterr().out


@pytest.mark.parametrize(("step", "at_s", "cell"), [(0.02, 0.35, "0.4"), (0.02, 0.75, "0.8")])
def test_where_and_when_an_arm_moved_is_said(step: float, at_s: float, cell: str) -> None:
    moved = readings(np.zeros(12)) * 1.0
    rng = np.random.default_rng(2)
    moved += 1e-4 * rng.standard_normal(moved.shape)
    begin = round(10 * at_s + 0.5) * 100
    moved[begin : begin + 100, 7] += step
    with pytest.raises(NotIdentifiable, match=rf"the arm moves: s3y is 0.02 m/s² off its median after {cell} s"):
        bias_at_rest(ARM, np.zeros(2), moved, RATE_HZ)


def test_a_sensor_without_gravity_is_off_by_all_that_it_reads() -> None:
    coupled = replace(ARM, sensors=tuple(replace(one, highpass_hz=0.2) for one in ARM.sensors))
    found = bias_at_rest(coupled, np.zeros(2), readings(np.zeros(12)), RATE_HZ)
    np.testing.assert_allclose(found.bias_m_s2, np.tile([0.0, 0.0, G], (4, 1)), atol=1e-9)
    felt = bias_at_rest(ARM, np.zeros(2), readings(np.zeros(12)), RATE_HZ)
    np.testing.assert_allclose(felt.bias_m_s2, np.zeros((4, 3)), atol=1e-9)
    assert felt.bias_m_s2.shape == felt.std.shape == (4, 3)


def test_four_samples_tell_a_bias_and_its_error() -> None:
    level = np.tile([0.0, 0.0, G], 4) + 0.01 * np.random.default_rng(1).standard_normal((4, 12))
    found = bias_at_rest(ARM, np.zeros(2), level, 1.0)
    assert np.all(np.isfinite(found.bias_m_s2)) and np.all(np.isfinite(found.std)) and np.all(found.std > 0.0)


def test_an_arm_that_moves_is_refused_and_nothing_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    moving = readings(np.zeros(12)) + 0.5 * np.linspace(0.0, 1.0, round(RATE_HZ))[:, None]
    monkeypatch.setattr(module, "sample_burst", lambda *_: (RATE_HZ, moving))
    out = tmp_path / "zeroed.toml"
    assert main(["zero", "--port", "/dev/ttyX", "--arm", "dd-arm", "--out", str(out)]) == 4
    assert "error: the arm moves: " in " ".join(capsys.readouterr().err.split())
    assert not out.exists()
