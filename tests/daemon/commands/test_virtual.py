"""`limbd virtual` as a program: the serial protocol, as any host sees it."""

import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import serial

from arm.arm_file import load_arm
from daemon.__main__ import main
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
        (("--highpass-hz", "-0.1"), "'-0.1' is not a number of at least 0"),
        (("--trials", "1.5"), "'1.5' is not a whole number"),
    ],
)
def test_wrong_arguments(arguments: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["virtual", *arguments]) == 2
    assert said in " ".join(capsys.readouterr().err.split())
