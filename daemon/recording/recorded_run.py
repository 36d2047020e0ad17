"""What a recording says of its run: the device, the samples block by block, and when they were taken."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain, dropwhile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from daemon.clock.device_clock import ClockState
from limbcal.errors import DataError, ProtocolError
from protocol.device_info import Channel, DeviceInfo
from protocol.message import HEALTH, RAW
from protocol.recording_files import files_of
from protocol.recording_reader import read_recording

#: Ticks of a replayed device: fine enough that a single lost sample is beyond doubt.
TICKS_PER_SAMPLE = 1000
#: This number of blocks that were passed is remembered: more than wait in the ring.
_PASSED = 8192
_INT16 = np.iinfo(np.int16)


@dataclass(frozen=True)
class Block:
    """Samples of a recording.

    Attributes
    ----------
    sample0, t0_ns : int
        Number and UTC [ns] of the first.
    dt_s : float
        From one to the next.
    a : (n_sample, n_channel) [m/s^2], float32
    """

    sample0: int
    t0_ns: int
    dt_s: float
    a: NDArray[np.float32]


def device_of(path: Path) -> DeviceInfo:
    """Return what the recorded device said of itself, with a clock that counts samples.

    Raises
    ------
    DataError
        If the recording does not say.
    """
    with read_recording(path, [HEALTH]) as messages:
        for _, fields, _ in messages:
            found = fields.get("device")
            if isinstance(found, dict):
                return _device(path, found)
    raise DataError(f"recording {path}: nothing says what the device was, expected a recording of `limbd run`")


def files_from(path: Path) -> list[Path]:
    """Return a file of a recording and those that its run went on with, as far as they are there, in order."""
    return [path, *[*dropwhile(lambda file: file != path, files_of(path))][1:]]


def blocks_of(path: Path) -> Iterator[Block]:
    """Yield the blocks of a recording and of those that its run went on with, in order, each once.

    After a disk failed, the next file repeats what may not have reached the one before.

    Parameters
    ----------
    path : Path
        Any file of the run; those before it are not read, and those that are not there any more are passed over.

    Raises
    ------
    DataError
        If a file cannot be read.
    """
    reached = 0
    for file in files_from(path):
        with read_recording(file, [RAW]) as messages:
            for _, fields, _ in messages:
                block = Block(int(fields["sample0"]), int(fields["t0_ns"]), float(fields["dt_s"]), fields["a"])
                if block.sample0 >= reached:
                    reached = block.sample0 + len(block.a)
                    yield block


def counts_of(block: Block, info: DeviceInfo) -> NDArray[np.int16]:
    """Return the counts that the device sent.

    Raises
    ------
    DataError
        If the accelerations are not those of whole counts.
    """
    scale, offset = (
        np.array([getattr(channel, name) for channel in info.channels]) for name in ("scale", "offset")
    )
    counts: Floats = np.rint((block.a.astype(float) - offset) / scale)
    again = (counts * scale + offset).astype(np.float32)
    if counts.min() < _INT16.min or counts.max() > _INT16.max or not np.array_equal(again, block.a):
        raise DataError(f"recording: sample {block.sample0} and those after it are no counts of {info.device}")
    whole: NDArray[np.int16] = counts.astype(np.int16)
    return whole


class _Times(NamedTuple):
    """Number and UTC [ns] of a block's first sample, and the time from one to the next."""

    sample0: int
    t0_ns: int
    dt_s: float


class RecordedClock:
    """The time of a replayed sample: when it was taken, and how long it took.

    Parameters
    ----------
    path : Path
        The recording; read as far as it is asked about. What lies behind by less than the ring holds can still be
        asked.
    """

    def __init__(self, path: Path) -> None:
        self._blocks = blocks_of(path)
        self._here = next(self._blocks)
        self._next: Block | None = next(self._blocks, None)
        self._passed: deque[_Times] = deque(maxlen=_PASSED)

    @property
    def state(self) -> ClockState:
        """Nothing: it is no clock that runs."""
        return ClockState(None, None, None)

    def utc_ns(self, ticks: int) -> int:
        """Return UTC [ns] at a tick."""
        sample, times = ticks // TICKS_PER_SAMPLE, self._times(ticks)
        return times.t0_ns + round((sample - times.sample0) * 1e9 * times.dt_s)

    def dt_s(self, ticks: int) -> float:
        """Return the time from one sample to the next at a tick."""
        return self._times(ticks).dt_s

    def _times(self, ticks: int) -> _Times:
        sample = ticks // TICKS_PER_SAMPLE
        while self._next is not None and self._next.sample0 <= sample:
            self._passed.append(_times_of(self._here))
            self._here, self._next = self._next, next(self._blocks, None)
        here = _times_of(self._here)
        return next((one for one in chain([here], reversed(self._passed)) if one.sample0 <= sample), here)

    def monotonic_ns(self, ticks: int) -> int:
        """Return the same: nothing else is known."""
        return self.utc_ns(ticks)

    def early_s(self, ticks: int, arrival_ns: int) -> float:
        """Return 0: samples were taken long ago."""
        return 0.0

    def note(self, ticks: int, arrival_ns: int) -> None:
        """Pass over when a sample came again."""


def _times_of(block: Block) -> _Times:
    return _Times(block.sample0, block.t0_ns, block.dt_s)


def _device(path: Path, found: dict[str, Any]) -> DeviceInfo:
    try:
        channels = tuple(Channel(**channel) for channel in found["channels"])
        info = DeviceInfo(**{**found, "channels": channels})
        DeviceInfo.from_json(info.to_json())
    except (TypeError, KeyError, ValueError, ProtocolError) as error:
        raise DataError(f"recording {path}: what it says of the device makes no sense: {error}") from error
    return replace(info, tick_hz=TICKS_PER_SAMPLE * info.rate_hz)
