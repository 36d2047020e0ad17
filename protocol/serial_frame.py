"""Frames on the serial line, device to host: how they are laid out and built.

A frame is a 24-byte header that carries its own CRC-16, a payload, and the payload's CRC-32. All numbers are
little-endian.
"""

import binascii
import json
import math
import struct
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import ProtocolError

MAGIC = b"\xa5\x5a"
VERSION = 1
KIND_INFO = 1
KIND_SAMPLES = 2
HEADER_BYTES = 24
PAYLOAD_CRC_BYTES = 4
MAX_PAYLOAD_BYTES = 0xFFFF
#: Sequence numbers wrap here.
SEQUENCES = 1 << 32

#: magic, version, kind, sequence, ticks, samples, channels, payload bytes: what the header CRC covers.
HEADER = struct.Struct("<2sBBIQHHH")
HEADER_CRC = struct.Struct("<H")
PAYLOAD_CRC = struct.Struct("<I")

_COUNTS = np.dtype("<i2")


@dataclass(frozen=True)
class Channel:
    """One channel of the device: ``value = scale * count + offset`` [m/s^2], valid up to ``full_scale``."""

    name: str
    scale: float
    offset: float
    full_scale: float


@dataclass(frozen=True)
class DeviceInfo:
    """What a device says of itself; the payload of an INFO frame."""

    device: str
    serial: str
    firmware: str
    rate_hz: float
    tick_hz: float
    channels: tuple[Channel, ...]

    def to_json(self) -> bytes:
        """Return the payload of an INFO frame, UTF-8 JSON."""
        return json.dumps(asdict(self), separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()

    @classmethod
    def from_json(cls, payload: bytes) -> "DeviceInfo":
        """Read the payload of an INFO frame; keys that this version does not know are passed over.

        Raises
        ------
        ProtocolError
            If it is not a JSON object, or a field is missing, of another type or out of range.
        """
        try:
            document = json.loads(payload.decode("utf-8"))
        except (ValueError, RecursionError) as error:
            raise ProtocolError(f"INFO: found {payload[:40]!r}, expected UTF-8 JSON ({error})") from error
        if not isinstance(document, dict):
            raise ProtocolError(f"INFO: found a JSON {type(document).__name__}, expected an object")
        found = document.get("channels")
        if not isinstance(found, list) or not found:
            raise ProtocolError(f"INFO: channels is {_short(found)}, expected a list of at least one channel")
        channels = tuple(_channel(entry, f"INFO: channels[{place}]") for place, entry in enumerate(found))
        names = [channel.name for channel in channels]
        if len(set(names)) < len(names):
            raise ProtocolError(f"INFO: channel names are {names}, expected each only once")
        return cls(
            device=_text(document, "device", "INFO"),
            serial=_text(document, "serial", "INFO"),
            firmware=_text(document, "firmware", "INFO"),
            rate_hz=_positive(document, "rate_hz", "INFO"),
            tick_hz=_positive(document, "tick_hz", "INFO"),
            channels=channels,
        )


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


def _channel(entry: Any, where: str) -> Channel:
    if not isinstance(entry, dict):
        raise ProtocolError(f"{where} is {_short(entry)}, expected an object")
    scale = _number(entry, "scale", where)
    if scale == 0.0:
        raise ProtocolError(f"{where}: scale is 0, expected a number other than 0")
    return Channel(
        name=_text(entry, "name", where),
        scale=scale,
        offset=_number(entry, "offset", where),
        full_scale=_positive(entry, "full_scale", where),
    )


def _text(fields: Mapping[str, Any], name: str, where: str) -> str:
    value = fields.get(name)
    if not isinstance(value, str):
        raise ProtocolError(f"{where}: {name} is {_short(value)}, expected a string")
    return value


def _number(fields: Mapping[str, Any], name: str, where: str) -> float:
    value = fields.get(name)
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:  # an integer beyond what a float holds
            number = math.inf
        if math.isfinite(number):
            return number
    raise ProtocolError(f"{where}: {name} is {_short(value)}, expected a finite number")


def _positive(fields: Mapping[str, Any], name: str, where: str) -> float:
    number = _number(fields, name, where)
    if number <= 0.0:
        raise ProtocolError(f"{where}: {name} is {number:g}, expected a number above 0")
    return number


def _short(value: object) -> str:
    if value is None:
        return "missing"
    if isinstance(value, int) and abs(value) >= 10**40:  # repr of a very long integer raises
        return "an integer of more than 40 digits"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
