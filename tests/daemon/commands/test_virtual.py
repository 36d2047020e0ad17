"""`limbd virtual` as a program: the serial protocol, as any host sees it."""

import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import serial

from arm.arm_file import load_arm
from arm.counts import COUNT_M_S2
from daemon.virtual_device.virtual_device import Timing, VirtualDevice
from daemon.virtual_device.virtual_loop import VirtualOptions, serve
from daemon.virtual_device.virtual_motion import BenchPlan, stretches
from protocol.serial_frame import InfoFrame, SamplesFrame
from protocol.serial_parser import FrameParser

Limbd = Callable[..., Any]


@pytest.fixture
def host() -> Iterator[Callable[[str], serial.Serial]]:
    ports: list[serial.Serial] = []

    def connect(path: str) -> serial.Serial:
        ports.append(serial.Serial(path, 12_000_000, timeout=1.0))
        return ports[-1]

    yield connect
    for port in ports:
        port.close()


def read_samples(port: serial.Serial, n: int) -> list[SamplesFrame | InfoFrame]:
    parser, frames, samples = FrameParser(), [], 0
    while samples < n:
        for frame in parser.feed(port.read(max(1, port.in_waiting))):
            frames.append(frame)
            samples += len(frame.counts) if isinstance(frame, SamplesFrame) else 0
    assert parser.counters.crc_errors == 0
    return frames


def test_it_speaks_the_protocol_and_outlives_its_host(
    limbd: Limbd, host: Callable[[str], serial.Serial], tmp_path: Path
) -> None:
    truth = tmp_path / "truth.npz"
    device = limbd("virtual", "--rate-hz", "4000", "--trials", "1", "--seed", "9", "--truth", str(truth), "--json")
    path = device.announcement()["port"]
    plan = BenchPlan(load_arm("dd-arm"), seed=9, rate_hz=4000.0, trials=1)
    expected = next(stretches(plan))
    for _ in range(2):  # a host that goes without STOP is no harm to the device
        port = host(path)
        port.write(b"STOP\nINFO\nSTART\n")
        frames = read_samples(port, 2000)
        infos = [frame for frame in frames if isinstance(frame, InfoFrame)]
        samples = [frame for frame in frames if isinstance(frame, SamplesFrame) and frame.ticks >= infos[-1].ticks]
        assert infos[-1].info.rate_hz == 4000.0
        assert [channel.name for channel in infos[-1].info.channels][:4] == ["s1x", "s1y", "s1z", "s2x"]
        counts = np.concatenate([frame.counts for frame in samples])
        np.testing.assert_array_equal(counts, expected.counts[: len(counts)])
        port.close()
    device.signal(signal.SIGINT)
    assert device.wait() == 0
    with np.load(truth) as written:
        assert written["t"].size >= 500 - 10
        for name, values in expected.truth.items():
            np.testing.assert_array_equal(written[name], values[: written["t"].size])


def test_ac_coupled_sensors_show_no_weight(limbd: Limbd, host: Callable[[str], serial.Serial]) -> None:
    options = ("--arm", "spatial-arm", "--rate-hz", "1000", "--trials", "0", "--highpass-hz", "0.5", "--json")
    device = limbd("virtual", *options, "--seed", "2")
    announced = device.announcement()
    assert announced["arm"] == "spatial-arm" and announced["highpass_hz"] == 0.5
    port = host(announced["port"])
    port.write(b"START\n")
    counts = np.concatenate([f.counts for f in read_samples(port, 320) if isinstance(f, SamplesFrame)])
    plan = BenchPlan(load_arm("spatial-arm"), seed=2, rate_hz=1000.0, trials=0, highpass_hz=0.5)
    np.testing.assert_array_equal(counts[:320], next(stretches(plan)).counts[:320])
    assert np.abs(counts * COUNT_M_S2).max() < 0.3
    assert device.stop() == 0


def test_it_says_its_path(limbd: Limbd, tmp_path: Path) -> None:
    device = limbd("virtual", "--link", str(tmp_path / "link"), "--rate-hz", "1000", "--trials", "0")
    path = device.process.stdout.readline().strip()
    assert (tmp_path / "link").readlink() == Path(path)
    assert device.stop() == 0


def test_its_port_is_there_when_it_answers_and_not_before(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    link, seen = tmp_path / "link", []

    def ready(_device: VirtualDevice, _timeout_s: float) -> bool:
        seen.append(link.exists())
        return len(seen) == 2  # kernels are compiled for a while

    monkeypatch.setattr(VirtualDevice, "ready", ready)
    monkeypatch.setattr(
        "daemon.virtual_device.virtual_loop.emit", lambda path: seen.append(link.readlink() == Path(path))
    )
    monkeypatch.setattr("daemon.virtual_device.virtual_loop._serve", lambda *_: None)
    plan = BenchPlan(load_arm("dd-arm"), seed=0, rate_hz=1000.0, trials=0)
    serve(VirtualOptions(plan, 1000.0, Timing(1000.0), 1.0, link, None, as_json=False))
    assert seen == [False, False, True]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--arm", "nobody"), "arm 'nobody': No such file"),
        (("--speed", "0"), "'0' is not a number above 0"),
        (("--noise", "nan"), "'nan' is not a number of at least 0"),
        (("--highpass-hz", "-0.1"), "'-0.1' is not a number of at least 0"),
        (("--trials", "-1"), "'-1' is not a whole number"),
        (("--trials", "1.5"), "'1.5' is not a whole number"),
    ],
)
def test_wrong_arguments(limbd: Limbd, arguments: tuple[str, ...], said: str) -> None:
    device = limbd("virtual", *arguments)
    assert device.wait() == 2
    assert said in device.said
