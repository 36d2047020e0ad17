"""What a haptic device says and hears: single-part msgpack maps with ``"v": 1``."""

import math
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from limbcal.errors import ProtocolError
from protocol.message import decode_payload, encode

#: Bytes of an input; it is some hundred.
INPUT_LIMIT = 4096
COMMANDS = ("state", "hold", "free", "reset")
_INPUT_FIELDS = frozenset({"v", "position", "velocity", "joint", "point", "orientation", "seq"})
_COMMAND_FIELDS = frozenset({"v", "cmd", "q", "seq"})
#: Farther from the base than any hand [m], and faster [m/s].
_FARTHEST_M, _FASTEST_M_S = 1e3, 1e4
#: By how much the length of a unit quaternion may be off [1]: more than single precision leaves.
_UNIT = 1e-3


@dataclass(frozen=True)
class Input:
    """Where a device is [m], what of it is touched, and what its sender calls this input.

    ``joint`` counts from 1; without it and ``point`` the tip is touched. ``orientation`` is (3, 3).
    """

    position: Floats
    velocity: Floats | None = None
    joint: int | None = None
    point: tuple[float, float, float] | None = None
    orientation: Floats | None = None
    seq: int | None = None


@dataclass(frozen=True)
class Command:
    """One of `COMMANDS`; ``q`` goes with hold and reset."""

    cmd: str
    q: Floats | None = None
    seq: int | None = None


def encode_input(fields: Mapping[str, object]) -> bytes:
    """Return an input or a command as it travels."""
    return encode("haptic", {name: value for name, value in fields.items() if value is not None})[1]


def decode_input(payload: bytes, n_joint: int) -> Input | Command:
    """Read what a device says.

    Raises
    ------
    ProtocolError
        If it is too big, no msgpack map, of another version, or a field is not what it must be.
    """
    if len(payload) > INPUT_LIMIT:
        raise ProtocolError(f"input: {len(payload)} bytes, expected at most {INPUT_LIMIT}")
    fields = decode_payload("input", payload)
    known = _COMMAND_FIELDS if "cmd" in fields else _INPUT_FIELDS
    if unknown := fields.keys() - known:
        raise ProtocolError(f"input: there is no field {reprlib.repr(min(unknown))} here")
    seq = _whole("seq", fields.get("seq"), 0, 2**63 - 1)
    if "cmd" in fields:
        cmd = fields["cmd"]
        if not isinstance(cmd, str) or cmd not in COMMANDS:
            raise ProtocolError(f"input: cmd is {reprlib.repr(cmd)}, expected one of {', '.join(COMMANDS)}")
        q = fields.get("q")
        if q is not None and cmd not in ("hold", "reset"):
            raise ProtocolError(f"input: {cmd} takes no q")
        return Command(cmd, None if q is None else _numbers("q", q, n_joint, _FASTEST_M_S), seq)
    if "position" not in fields:
        raise ProtocolError("input: the field 'position' is missing")
    joint, point = _whole("joint", fields.get("joint"), 1, n_joint), fields.get("point")
    velocity, orientation = fields.get("velocity"), fields.get("orientation")
    place: tuple[float, float, float] | None = None
    if point is not None:
        x, y, z = _numbers("point", point, 3, _FARTHEST_M).tolist()
        place = (x, y, z)
    return Input(
        _numbers("position", fields["position"], 3, _FARTHEST_M),
        None if velocity is None else _numbers("velocity", velocity, 3, _FASTEST_M_S),
        joint,
        place,
        None if orientation is None else _rotation(_numbers("orientation", orientation, 4, 2.0)),
        seq,
    )


def decode_reply(payload: bytes) -> dict[str, object]:
    """Read a message to a device.

    Raises
    ------
    ProtocolError
        If it is no msgpack map, or of another version.
    """
    return decode_payload("haptic", payload)


def _numbers(name: str, value: object, n: int, most: float) -> Floats:
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.dtype.kind in "fi" else None
    if not isinstance(value, list) or len(value) != n:
        raise ProtocolError(f"input: {name} is {reprlib.repr(value)}, expected {n} numbers")
    for number in value:
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise ProtocolError(f"input: {name} has {reprlib.repr(number)} in it, expected {n} numbers")
        if not abs(number) <= most:  # nor is it where it is not a number
            raise ProtocolError(f"input: {name} has {number} in it, expected numbers within ±{most:g}")
    return np.array(value, dtype=np.float64)


def _whole(name: str, value: object, least: int, most: int) -> int | None:
    if value is None:
        return None
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
        raise ProtocolError(f"input: {name} is {reprlib.repr(value)}, expected a whole number {least} to {most}")
    return value


def _rotation(quaternion: Floats) -> Floats:
    """Return the rotation matrix of a unit quaternion w, x, y, z."""
    size = math.sqrt(float(quaternion @ quaternion))
    if abs(size - 1.0) > _UNIT:
        raise ProtocolError(f"input: orientation has length {size:g}, expected a unit quaternion w, x, y, z")
    w, x, y, z = (quaternion / size).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
