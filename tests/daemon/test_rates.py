"""Devices whose rate is low or not what they say, or whose tick counter passes zero, lose nothing."""

from pathlib import Path

import numpy as np
import pytest

from daemon.virtual_device.virtual_device import FRAME_SAMPLES
from protocol.message import GAP, HEALTH, RAW
from tests.daemon.live_run import Fields, Heard, Limbd, check, dropped, live_run, sent

#: A test machine may be busy, or full.
OF_THE_MACHINE = {"behind", "disk"}
PPM = 1e-6


def check_losses(heard: Heard, said: str, frame_samples: int) -> Fields:
    """Nothing is missing but what the device had to drop, and that is stated; return the last health."""
    last, lost = heard[HEALTH][-1], dropped(said) * frame_samples
    assert sum(gap["samples"] for gap in heard[GAP]) == last["lost_samples"] == lost
    assert all(gap["exact"] for gap in heard[GAP]) and {gap["why"] for gap in heard[GAP]} <= {"frames missing"}
    assert sum(last["gaps"]["causes"].values()) == len(heard[GAP])
    return last


@pytest.mark.parametrize(
    ("claimed_hz", "sampled_hz", "frame_samples", "options"),
    [(8000.0, 7680.0, 256, ("--wraps-s", "8")), (100.0, 104.0, 8, ())],
)
def test_a_rate_is_followed_and_said(
    limbd: Limbd,
    tmp_path: Path,
    claimed_hz: float,
    sampled_hz: float,
    frame_samples: int,
    options: tuple[str, ...],
) -> None:
    given = ("--sampled-hz", str(sampled_hz), "--frame-samples", str(frame_samples), *options)
    method = "integrate" if claimed_hz > 1000.0 else "filter"
    heard, said = live_run(
        limbd, tmp_path, "", claimed_hz, round(4.0 * sampled_hz), device_options=given, method=method
    )
    check(heard, sent(sampled_hz, round(10.0 * sampled_hz)))
    last = check_losses(heard, said, frame_samples)
    assert last["rate_hz"] == pytest.approx(sampled_hz, rel=100 * PPM)
    assert last["rate"]["claimed_hz"] == claimed_hz
    alarms = {alarm["name"] for health in heard[HEALTH] for alarm in health["alarms"]} - OF_THE_MACHINE
    assert alarms == {"rate"}
    assert heard[RAW][-1]["dt_s"] == pytest.approx(1.0 / sampled_hz, rel=150 * PPM)
    stamps = np.array([block["t0_ns"] for block in heard[RAW]]) * 1e-9
    numbers = np.array([block["sample0"] for block in heard[RAW]])
    late = numbers >= 2 * sampled_hz
    # Where a machine was busy, stamps step back as soon as a block comes less late than all before it.
    rate_hz = np.median(np.diff(numbers[late]) / np.diff(stamps[late]))
    assert rate_hz == pytest.approx(sampled_hz, rel=0.005)


def test_a_clock_without_a_crystal_is_followed_by_the_hosts(limbd: Limbd, tmp_path: Path) -> None:
    ppm = -40_000.0
    sampled_hz = 4000.0 * (1.0 + PPM * ppm)
    given = ("--clock-ppm", str(ppm))
    heard, said = live_run(limbd, tmp_path, "", 4000.0, round(6.0 * sampled_hz), device_options=given)
    last = check_losses(heard, said, FRAME_SAMPLES)
    off_ppm = (last["rate_hz"] / sampled_hz - 1.0) / PPM
    assert abs(off_ppm) < max(100.0, 3.0 * last["rate"]["std_ppm"])
    assert abs(last["clock_ppm"] - ppm) < max(100.0, 3.0 * last["clock"]["ppm_std"])
    assert heard[RAW][-1]["dt_s"] == pytest.approx(1.0 / sampled_hz, rel=0.01)
    (alarm,) = [one for one in last["alarms"] if one["name"] not in OF_THE_MACHINE]
    assert alarm["name"] == "rate" and "slower than the 4000 Hz of its INFO" in alarm["found"]
