"""Frames on the serial line, device to host: how they are laid out and built.

A frame is a 24-byte header that carries its own CRC-16, a payload, and the payload's CRC-32. All numbers are
little-endian.
"""

import binascii
import struct
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import ProtocolError
from protocol.device_info import DeviceInfo

MAGIC = b"\xa5\x5a"
VERSION = 1
KIND_INFO = 1
KIND_SAMPLES = 2
HEADER_BYTES = 24
PAYLOAD_CRC_BYTES = 4
MAX_PAYLOAD_BYTES = 0xFFFF
#: Sequence numbers wrap here.
SEQUENCES = 1 << 32
#: A number further ahead than this is one behind.
HALF_WAY = SEQUENCES >> 1

#: magic, version, kind, sequence, ticks, samples, channels, payload bytes: what the header CRC covers.
HEADER = struct.Struct("<2sBBIQHHH")
HEADER_CRC = struct.Struct("<H")
PAYLOAD_CRC = struct.Struct("<I")

_COUNTS = np.dtype("<i2")


@dataclass(frozen=True, slots=True, eq=False)
class SamplesFrame:
    """A block of samples: ``counts`` is (n_sample, n_channel) int16, ``ticks`` the clock at its first row."""

    sequence: int
    ticks: int
    counts: NDArray[np.int16]


@dataclass(frozen=True, slots=True, eq=False)
class SamplesRun:
    """Frames of samples that are numbered on from ``sequence`` and alike but for their clocks, ``ticks``.

    ``counts`` (n_sample, n_channel) are those of all of them, one frame after the other.
    """

    sequence: int
    ticks: list[int]
    counts: NDArray[np.int16]

    @property
    def frame_samples(self) -> int:
        """Samples of each frame."""
        return len(self.counts) // len(self.ticks)

    def frames(self) -> list[SamplesFrame]:
        """Return the frames one by one."""
        return [self._frame(k) for k in range(len(self.ticks))]

    def last(self) -> SamplesFrame:
        """Return the last frame."""
        return self._frame(len(self.ticks) - 1)

    def _frame(self, k: int) -> SamplesFrame:
        n = self.frame_samples
        return SamplesFrame((self.sequence + k) % SEQUENCES, self.ticks[k], self.counts[k * n : (k + 1) * n])


@dataclass(frozen=True, slots=True)
class InfoFrame:
    """The device's description of itself."""

    sequence: int
    ticks: int
    info: DeviceInfo


def encode_info(info: DeviceInfo, sequence: int, ticks: int) -> bytes:
    """Return an INFO frame.

    Parameters
    ----------
    info : DeviceInfo
    sequence : int
        Frame number; wraps at 2**32.
    ticks : int
        Device clock, 0 to 2**64 - 1.

    Raises
    ------
    ProtocolError
        If the description does not fit a frame.
    """
    return _frame(KIND_INFO, sequence, ticks, 0, len(info.channels), info.to_json())


def encode_samples(counts: NDArray[np.int16], sequence: int, ticks: int) -> bytes:
    """Return a SAMPLES frame.

    Parameters
    ----------
    counts : (n_sample, n_channel) int16
    sequence : int
        Frame number; wraps at 2**32.
    ticks : int
        Device clock at the first sample, 0 to 2**64 - 1.

    Raises
    ------
    ProtocolError
        If the counts are of another type or shape, or do not fit a frame.
    """
    if counts.dtype != np.int16 or counts.ndim != 2 or counts.size == 0:
        raise ProtocolError(
            f"SAMPLES: counts are {counts.dtype}{counts.shape}, expected int16 of shape (n_sample, n_channel)"
        )
    n_sample, n_channel = counts.shape
    return _frame(KIND_SAMPLES, sequence, ticks, n_sample, n_channel, counts.astype(_COUNTS).tobytes())


def header_crc(header: bytes | memoryview) -> int:
    """Return CRC-16/CCITT-FALSE of the first 22 bytes of a frame."""
    return binascii.crc_hqx(header, 0xFFFF)


def _frame(kind: int, sequence: int, ticks: int, samples: int, channels: int, payload: bytes) -> bytes:
    if len(payload) > MAX_PAYLOAD_BYTES:
        raise ProtocolError(f"frame: payload of {len(payload)} bytes, expected at most {MAX_PAYLOAD_BYTES}")
    if not 0 <= ticks < 1 << 64:
        raise ProtocolError(f"frame: device clock is {ticks} ticks, expected 0 to 2**64 - 1")
    header = HEADER.pack(MAGIC, VERSION, kind, sequence % SEQUENCES, ticks, samples, channels, len(payload))
    return b"".join((header, HEADER_CRC.pack(header_crc(header)), payload, PAYLOAD_CRC.pack(zlib.crc32(payload))))
