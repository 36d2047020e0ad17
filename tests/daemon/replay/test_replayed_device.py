"""A recording as a device: what it answers, and which samples are due when."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from daemon.replay.replayed_device import ReplayedDevice
from limbcal.errors import DataError
from protocol.message import RAW
from protocol.serial_frame import InfoFrame, SamplesFrame
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import SCALE, device_info
from tests.daemon.test_replay import health_of, make, raw_fields

INFO = device_info(8000.0)


def recording(folder: Path, *first_samples: int) -> Path:
    """Record blocks of 80 samples, 10 ms each; each sample's first channel counts its number."""
    blocks = []
    for sample0 in first_samples:
        a = np.zeros((80, 12))
        a[:, 0] = SCALE * np.arange(sample0, sample0 + 80)
        blocks.append((RAW, raw_fields(sample0, a)))
    return make(folder / "run.mcap", health_of(asdict(INFO)), *blocks)


def sent(device: ReplayedDevice) -> list[InfoFrame | SamplesFrame]:
    out = bytearray()

    def take(data: bytes) -> int:
        out.extend(data)
        return len(data)

    device.out.drain(take)
    return FrameParser().feed(bytes(out))


def started(device: ReplayedDevice, at_s: float = 100.0) -> ReplayedDevice:
    device.receive(b"START\n", at_s)
    return device


def numbers(frames: list[InfoFrame | SamplesFrame]) -> list[tuple[int, int, int]]:
    """Return each frame's clock, samples and first count."""
    return [
        (one.ticks, *one.counts.shape[:1], int(one.counts[0, 0]))
        for one in frames
        if isinstance(one, SamplesFrame)
    ]


@pytest.mark.parametrize(("speed", "lasts_s"), [(1.0, 0.01), (2.0, 0.005), (0.5, 0.02)])
def test_a_block_is_sent_when_its_last_sample_is_due(tmp_path: Path, speed: float, lasts_s: float) -> None:
    device = started(ReplayedDevice(recording(tmp_path, 0, 80, 160), speed))
    device.advance(100.0 + 0.99 * lasts_s)
    assert numbers(sent(device)) == []
    device.advance(100.0 + 1.01 * lasts_s)
    assert numbers(sent(device)) == [(0, 32, 0), (32_000, 32, 32), (64_000, 16, 64)]
    assert not device.played
    device.advance(100.0 + 3.01 * lasts_s)
    assert [ticks for ticks, _, _ in numbers(sent(device))] == [1000 * n for n in (80, 112, 144, 160, 192, 224)]
    assert device.played


def test_samples_that_were_lost_take_their_time(tmp_path: Path) -> None:
    device = started(ReplayedDevice(recording(tmp_path, 800, 880, 1040), 1.0))
    for after_ms, ticks in ((19, [800_000]), (21, [880_000]), (31, []), (39, []), (41, [1_040_000])):
        device.advance(100.0 + 1e-3 * after_ms)
        assert [one[0] for one in numbers(sent(device))[:1]] == ticks
    assert device.played


def test_frames_are_numbered_on_from_the_first_answer(tmp_path: Path) -> None:
    device = ReplayedDevice(recording(tmp_path, 0, 80), 1.0)
    device.advance(200.0)  # nothing before it is started
    device.receive(b"INFO\nNONSENSE\nIN", 50.0)
    device.receive(b"FO\nSTART\n", 100.0)
    device.advance(100.011)
    device.receive(b"START\n", 100.015)  # which is no new beginning
    device.advance(100.021)
    found = sent(device)
    assert [one.sequence for one in found] == list(range(1, 11))
    infos = [one for one in found if isinstance(one, InfoFrame)]
    assert [(one.sequence, one.ticks) for one in infos] == [(1, 0), (2, 0), (3, 0), (7, 0)]
    assert (infos[0].info.rate_hz, infos[0].info.tick_hz) == (8000.0, 8_000_000.0)
    assert [one[2] for one in numbers(found)] == [0, 32, 64, 80, 112, 144]


def test_a_stop_is_the_end(tmp_path: Path) -> None:
    device = started(ReplayedDevice(recording(tmp_path, 0, 80), 1.0))
    device.receive(b"STOP\n", 100.001)
    device.advance(200.0)
    assert numbers(sent(device)) == [] and device.played


def test_no_more_is_made_than_its_reader_takes(tmp_path: Path) -> None:
    device = started(ReplayedDevice(recording(tmp_path, *range(0, 80 * 200, 80)), 1.0))
    device.advance(200.0)
    assert 1 << 18 <= len(device.out) < (1 << 18) + 2100 and not device.played
    assert len(numbers(sent(device))) == 3 * 131
    device.advance(200.0)
    assert len(numbers(sent(device))) == 3 * 69 and device.played and device.out.dropped == 0


def test_without_samples_there_is_nothing_to_replay(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="there is no limb/raw in it, expected samples to replay"):
        ReplayedDevice(make(tmp_path / "a.mcap", health_of(asdict(INFO))), 1.0)
