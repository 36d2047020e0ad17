"""Faults of a schedule act on device, line and port when it is their time, and end when it is over."""

from dataclasses import dataclass, field
from typing import Any

import pytest

from daemon.virtual_device.fault_injection import FaultInjection
from daemon.virtual_device.fault_schedule import faults_of
from protocol.device_info import DeviceInfo
from tests.daemon.conftest import device_info

START_S = 100.0


@dataclass
class Bench:
    """Device, line and port in one, which note what is done to them."""

    started_s: float | None = START_S
    plugged: bool = True
    acting: dict[str, float] = field(default_factory=dict)
    done: list[Any] = field(default_factory=list)
    rustled_s: float = 0.0

    def restart(self, now_s: float) -> None:
        self.done.append(("restart", now_s))

    def become(self, info: DeviceInfo) -> None:
        self.done.append(("become", info.serial))

    def cut(self) -> None:
        self.done.append("cut")

    def rustle(self, elapsed_s: float) -> None:
        self.rustled_s += elapsed_s

    def unplug(self) -> None:
        self.plugged = False
        self.done.append("unplug")

    def plug(self) -> None:
        self.plugged = True
        self.done.append("plug")


@pytest.fixture
def info() -> DeviceInfo:
    return device_info(8000.0)


def injected(bench: Bench, text: str, info: DeviceInfo) -> FaultInjection:
    return FaultInjection(faults_of(text), info, bench, bench, bench)  # type: ignore[arg-type] - one for all three


def at(bench: Bench, injection: FaultInjection, since_s: float) -> list[Any]:
    """Return what is done at a time since START."""
    bench.done.clear()
    injection.make(START_S + since_s)
    return list(bench.done)


def test_a_cable_is_pulled_once_and_plugged_in_once(info: DeviceInfo) -> None:
    bench = Bench()
    injection = injected(bench, "unplug@2+1", info)
    assert [at(bench, injection, s) for s in (0.0, 1.9)] == [[], []]
    assert at(bench, injection, 2.0) == ["unplug", "cut"]
    assert at(bench, injection, 2.9) == []
    assert not bench.plugged
    assert at(bench, injection, 3.1) == ["plug"]
    assert at(bench, injection, 4.0) == []


def test_power_is_gone_for_a_while_and_comes_back(info: DeviceInfo) -> None:
    bench = Bench()
    injection = injected(bench, "restart@1+0.5", info)
    assert at(bench, injection, 0.5) == []
    assert at(bench, injection, 1.2) == ["cut"]
    assert bench.acting == {"restart": 0.0}
    assert at(bench, injection, 1.4) == []
    assert at(bench, injection, 1.6) == [("restart", START_S + 1.6)]
    assert bench.acting == {}


def test_a_stranger_comes_by_way_of_the_socket_and_goes_so(info: DeviceInfo) -> None:
    bench = Bench()
    injection = injected(bench, "stranger@1+5", info)
    assert at(bench, injection, 1.0) == [("become", "a stranger"), "unplug", "cut"]
    assert at(bench, injection, 1.29) == []
    assert at(bench, injection, 1.31) == ["plug"]
    assert at(bench, injection, 5.9) == []
    assert at(bench, injection, 6.1) == [("become", info.serial), "unplug", "cut"]
    assert at(bench, injection, 6.5) == ["plug"]


def test_noise_lasts_as_long_as_time_passes(info: DeviceInfo) -> None:
    bench = Bench()
    injection = injected(bench, "garbage@0+9*50", info)
    for since_s in (0.0, 0.5, 2.0):
        at(bench, injection, since_s)
    assert bench.rustled_s == pytest.approx(2.0)
    assert bench.acting == {"garbage": 50.0}


def test_time_counts_from_the_first_start(info: DeviceInfo) -> None:
    bench = Bench(started_s=None)
    injection = injected(bench, "unplug@2+1", info)
    assert at(bench, injection, 2.5) == []  # nobody has asked it to start
    bench.started_s = START_S + 10.0
    assert at(bench, injection, 11.0) == []
    bench.started_s = START_S + 12.0  # started anew: the schedule goes on
    assert at(bench, injection, 12.5) == ["unplug", "cut"]


def test_without_faults_nothing_is_touched(info: DeviceInfo) -> None:
    bench = Bench(acting={"drop": 1.0})
    assert at(bench, injected(bench, "", info), 5.0) == []
    assert bench.acting == {"drop": 1.0}
