"""What a device says of itself, checked where it comes in: beyond this door every word and number is bounded.

What a device says ends in messages, file names, a log and somebody's terminal, so a text holds nothing but
characters that can be printed, and a number nothing that no accelerometer has.
"""

import json
import math
import reprlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from limbcal.errors import ProtocolError

#: Characters of a text; USB allows 126 in a descriptor, boards use some twenty.
MAX_TEXT = 128
#: Channels: what fits a frame of a single sample by far, and 85 sensors of three axes.
MAX_CHANNELS = 256
#: Samples in a second [Hz]: a thermometer's to ten times that of the fastest accelerometers' converters.
RATE_HZ = (0.1, 1e6)
#: Ticks in a second of the device's clock [Hz]: up to picoseconds.
TICK_HZ = (0.1, 1e12)
#: Acceleration of one count, of a full range, and of zero counts [m/s^2]: shock sensors end at 2e6.
SCALE_M_S2, FULL_SCALE_M_S2, OFFSET_M_S2 = (1e-12, 1e4), (1e-9, 1e8), (0.0, 1e8)


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
            If it is not a JSON object, or a field is missing, of another type or out of range. Its sentence shows
            what was found with every character that cannot be printed escaped.
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
        if len(found) > MAX_CHANNELS:
            raise ProtocolError(f"INFO: channels has {len(found)} entries, expected at most {MAX_CHANNELS}")
        channels = tuple(_channel(entry, f"INFO: channels[{place}]") for place, entry in enumerate(found))
        names = [channel.name for channel in channels]
        if len(set(names)) < len(names):
            raise ProtocolError(f"INFO: channel names are {_short(names)}, expected each only once")
        return cls(
            device=_text(document, "device", "INFO"),
            serial=_text(document, "serial", "INFO"),
            firmware=_text(document, "firmware", "INFO"),
            rate_hz=_within(document, "rate_hz", "INFO", RATE_HZ),
            tick_hz=_within(document, "tick_hz", "INFO", TICK_HZ),
            channels=channels,
        )


def _channel(entry: Any, where: str) -> Channel:
    if not isinstance(entry, dict):
        raise ProtocolError(f"{where} is {_short(entry)}, expected an object")
    return Channel(
        name=_text(entry, "name", where),
        scale=_within(entry, "scale", where, SCALE_M_S2, signed=True),
        offset=_within(entry, "offset", where, OFFSET_M_S2, signed=True),
        full_scale=_within(entry, "full_scale", where, FULL_SCALE_M_S2),
    )


def _text(fields: Mapping[str, Any], name: str, where: str) -> str:
    value = fields.get(name)
    if not isinstance(value, str):
        raise ProtocolError(f"{where}: {name} is {_short(value)}, expected a string")
    if len(value) > MAX_TEXT:
        raise ProtocolError(f"{where}: {name} has {len(value)} characters, expected at most {MAX_TEXT}")
    if not value.isprintable():
        raise ProtocolError(f"{where}: {name} is {_short(value)}, expected only characters that can be printed")
    return value


def _within(
    fields: Mapping[str, Any], name: str, where: str, limits: tuple[float, float], signed: bool = False
) -> float:
    number, (least, most) = _number(fields, name, where), limits
    size = abs(number) if signed else number
    if not least <= size <= most:
        span = f"up to {most:g}" if least == 0.0 else f"{least:g} to {most:g}"
        sign = " with either sign" if signed else ""
        raise ProtocolError(f"{where}: {name} is {number:g}, expected a number of {span}{sign}")
    return number


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


def _short(value: object) -> str:
    if value is None:
        return "missing"
    if isinstance(value, int) and abs(value) >= 10**40:  # repr of a very long integer raises
        return "an integer of more than 40 digits"
    text = reprlib.repr(value)  # a value nested a thousand deep must not exhaust the stack
    return text if len(text) <= 60 else text[:57] + "..."
