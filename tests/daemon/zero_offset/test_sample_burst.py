"""Samples are taken from a real pty by the reader process, or what is in the way is said."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from arm.arm_file import load_arm
from daemon.zero_offset import sample_burst as module
from daemon.zero_offset.sample_burst import sample_burst
from limbcal.errors import ConfigError, DeviceError
from protocol.serial_frame import encode_samples
from tests.daemon.conftest import device_info, resting_counts

MakeDevice = Callable[..., Any]
ARM = load_arm("dd-arm")
BAUD = 115200


def sample_frames(counts: NDArray[np.int16]) -> bytes:
    """Return frames numbered from 1 at 8 kHz and 1 MHz."""
    return b"".join(encode_samples(p, k + 1, k * 4000) for k, p in enumerate(np.split(counts, len(counts) // 32)))


def test_as_many_samples_as_were_asked_for(pty_device: MakeDevice) -> None:
    counts, info = resting_counts(6400), device_info(8000.0)
    device = pty_device(info, sample_frames(counts))
    rate_hz, a = sample_burst(device.path, BAUD, ARM, 0.5)
    assert rate_hz == 8000.0
    np.testing.assert_array_equal(np.rint(a / info.channels[0].scale), counts[:4000])
    assert device.commands.startswith(b"STOP\nINFO\n")
    assert device.commands.endswith(b"START\nSTOP\n")


def test_a_device_that_stays_silent_after_start(pty_device: MakeDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_SILENCE_S", 0.1)
    device = pty_device(device_info(8000.0))
    with pytest.raises(DeviceError, match="0 samples came and then none for 0.1 s, expected 8000"):
        sample_burst(device.path, BAUD, ARM, 1.0)


@pytest.mark.parametrize(("rate_hz", "seconds", "samples", "expected"), [(1.0, 0.5, 0, 4), (5.0, 0.6, 3, 0.8)])
def test_a_device_too_slow_for_the_time_that_was_asked_for(
    pty_device: MakeDevice, rate_hz: float, seconds: float, samples: int, expected: float
) -> None:
    device = pty_device(device_info(rate_hz))
    said = (
        f"--seconds is {seconds:g}, at the device's {rate_hz:g} Hz {samples} samples; "
        f"expected 4 or more, --seconds {expected:g}"
    )
    with pytest.raises(ConfigError, match=re.escape(said)):
        sample_burst(device.path, BAUD, ARM, seconds)
    assert b"START" not in device.commands


def test_another_arms_device(
    pty_device: MakeDevice,
) -> None:
    device = pty_device(device_info(names=["x", "y"]))
    with pytest.raises(DeviceError, match="the device's channels are x y, expected the sensors of arm 'dd-arm'"):
        sample_burst(device.path, BAUD, ARM, 1.0)


def test_a_port_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(DeviceError, match="does not exist, expected the serial port of the device"):
        sample_burst(str(tmp_path / "tty"), BAUD, ARM, 1.0)
