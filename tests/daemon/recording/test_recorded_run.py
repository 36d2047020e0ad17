"""The files of one run: a recording, and those that it went on with when it was full."""

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from daemon.recording.recorded_run import (
    TICKS_PER_SAMPLE,
    Block,
    RecordedClock,
    blocks_of,
    counts_of,
    device_of,
)
from limbcal.errors import DataError
from protocol.message import HEALTH, RAW, encode
from protocol.recording import RecordingWriter
from tests.daemon.conftest import device_info

T0_NS, DT_S = 1_700_000_000_000_000_000, 1.0 / 8000.0


def recorded(path: Path, blocks: list[Block], device: dict[str, Any] | None = None) -> Path:
    """Write what a daemon would have recorded."""
    with RecordingWriter(path, "", "") as writer:
        if device is not None:
            writer.write(HEALTH, encode(HEALTH, {"device": device})[1], T0_NS)
        for block in blocks:
            fields = {"sample0": block.sample0, "t0_ns": block.t0_ns, "dt_s": block.dt_s, "a": block.a}
            writer.write(RAW, encode(RAW, fields)[1], block.t0_ns)
    return path


def block(sample0: int, n: int = 80, late_ns: int = 0, dt_s: float = DT_S) -> Block:
    a = np.arange(sample0, sample0 + n, dtype=np.float32)[:, None] * np.ones(12, dtype=np.float32)
    return Block(sample0, T0_NS + round(sample0 * DT_S * 1e9) + late_ns, dt_s, a)


def test_the_device_is_the_one_that_was_recorded(
    tmp_path: Path,
) -> None:
    info = device_info(8000.0)
    path = recorded(tmp_path / "run.mcap", [block(0)], asdict(info))
    assert device_of(path) == replace(info, tick_hz=8000.0 * TICKS_PER_SAMPLE)  # a clock that counts samples


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"rate_hz": 0.0}, "rate_hz"),
        ({"channels": [{"name": "s1x"}]}, "scale"),
        ({"channels": None}, "NoneType"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_a_device_without_sense_is_said_with_its_file(tmp_path: Path, changed: dict[str, Any], said: str) -> None:
    path = recorded(tmp_path / "run.mcap", [block(0)], {**asdict(device_info(8000.0)), **changed})
    with pytest.raises(DataError, match=f"run.mcap: what it says of the device makes no sense: .*{said}"):
        device_of(path)


def test_a_recording_that_says_no_device_is_none_of_a_daemon(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="run.mcap: nothing says what the device was"):
        device_of(recorded(tmp_path / "run.mcap", [block(0)]))


def test_blocks_go_on_from_file_to_file(tmp_path: Path) -> None:
    first = recorded(tmp_path / "run.mcap", [block(0), block(80)])
    recorded(tmp_path / "run-002.mcap", [block(160, 40)])
    found = list(blocks_of(first))
    assert [(one.sample0, one.t0_ns, one.dt_s) for one in found] == [
        (k, T0_NS + round(k * DT_S * 1e9), DT_S) for k in (0, 80, 160)
    ]
    np.testing.assert_array_equal(np.concatenate([one.a for one in found])[:, 3], np.arange(200.0))


def test_blocks_that_the_next_file_repeats_come_once(tmp_path: Path) -> None:
    first = recorded(tmp_path / "run.mcap", [block(0), block(80), block(160)])
    recorded(tmp_path / "run-002.mcap", [block(80), block(160), block(240)])
    assert [one.sample0 for one in blocks_of(first)] == [0, 80, 160, 240]


@pytest.mark.parametrize(
    ("there", "asked", "found"),
    [
        ([1, 3, 4], 1, [1, 3, 4]),  # a number is used up by a file that could not be made
        ([2, 3], 2, [2, 3]),  # somebody took the first away
        ([1, 2, 3], 2, [2, 3]),
        ([2, 4, 5], 4, [4, 5]),
    ],
)
def test_a_run_goes_on_over_files_that_are_not_there(
    tmp_path: Path, there: list[int], asked: int, found: list[int]
) -> None:
    files = {1: tmp_path / "run.mcap", **{k: tmp_path / f"run-{k:03d}.mcap" for k in range(2, 6)}}
    for number in there:
        recorded(files[number], [block(80 * number)])
    assert [one.sample0 for one in blocks_of(files[asked])] == [80 * number for number in found]


def test_counts_are_those_that_were_sent() -> None:
    info = device_info(8000.0)
    info = replace(info, channels=tuple(replace(one, offset=0.25 * k) for k, one in enumerate(info.channels)))
    counts = np.random.default_rng(0).integers(-32768, 32768, (50, 12))
    counts[0, :2] = -32768, 32767
    a = (counts * info.channels[0].scale + 0.25 * np.arange(12)).astype(np.float32)
    np.testing.assert_array_equal(counts_of(Block(0, T0_NS, DT_S, a), info), counts)
    for wrong in (a + np.float32(0.4 * info.channels[0].scale), a + np.float32(info.channels[0].scale)):
        with pytest.raises(DataError, match="sample 7 and those after it are no counts of test device"):
            counts_of(Block(7, T0_NS, DT_S, wrong), info)


def test_samples_were_taken_when_their_block_says(tmp_path: Path) -> None:
    blocks = [block(0), block(80, late_ns=5_000_000), block(200, late_ns=9_000_000, dt_s=1.01 * DT_S)]
    clock = RecordedClock(recorded(tmp_path / "run.mcap", blocks))
    for sample in (0, 79, 80, 150, 200, 240, 90, 10, 230):  # those that were passed can still be asked of
        own = next(one for one in reversed(blocks) if one.sample0 <= sample)
        ticks = TICKS_PER_SAMPLE * sample
        assert clock.utc_ns(ticks) == own.t0_ns + round((sample - own.sample0) * own.dt_s * 1e9)
        assert clock.monotonic_ns(ticks) == clock.utc_ns(ticks)
        assert clock.dt_s(ticks) == own.dt_s
    assert clock.early_s(0, 10**18) == 0.0 and clock.state.ppm is None
