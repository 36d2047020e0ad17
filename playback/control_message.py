"""Requests and replies of the control socket: msgpack maps with ``"v": 1``."""

import math
import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from limbcal.errors import ProtocolError
from protocol.message import decode_payload, encode

DEFAULT_CONTROL = "tcp://127.0.0.1:5773"
REQUEST_LIMIT = 64 * 1024  # bytes; a request is some tens

Value = int | float | bool
#: A whole number that is sent as one in msgpack.
_WORD = 2**63


def _whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < _WORD


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


@dataclass(frozen=True)
class Field:
    """What a command takes: its name, what it may be, and that in words."""

    name: str
    fits: Callable[[object], bool]
    words: str


_WHOLE = f"a whole number from {1 - _WORD} to {_WORD - 1}"

#: Every command with what it takes besides v and cmd.
COMMANDS: Mapping[str, Field | None] = {
    "play": None,
    "pause": None,
    "stop": None,
    "seek": Field("position_s", _number, "a number of seconds"),
    "speed": Field("speed", _number, "a number"),
    "loop": Field("loop", lambda value: isinstance(value, bool), "true or false"),
    "step": Field("frames", _whole, _WHOLE),
    "load": Field("trial", _whole, _WHOLE),
    "list": None,
    "state": None,
    "arm": None,
    "motion": None,
}


@dataclass(frozen=True)
class Request:
    """What a client asks for, with the value of the command's field where it has one."""

    cmd: str
    value: Value | None = None


def encode_request(request: Request) -> bytes:
    """Return a request as it travels."""
    field = COMMANDS[request.cmd]
    return _pack({"cmd": request.cmd} | ({} if field is None else {field.name: request.value}))


def decode_request(parts: Sequence[bytes]) -> Request:
    """Read a request from the parts of its message that follow the address.

    Raises
    ------
    ProtocolError
        If it is not one part, too big, no msgpack map, of another version, or asks for what there is not.
    """
    if len(parts) != 1:
        raise ProtocolError(f"request: {len(parts)} parts, expected 1")
    (payload,) = parts
    if len(payload) > REQUEST_LIMIT:
        raise ProtocolError(f"request: {len(payload)} bytes, expected at most {REQUEST_LIMIT}")
    fields = decode_payload("request", payload)
    cmd = fields.get("cmd")
    if not isinstance(cmd, str) or cmd not in COMMANDS:
        raise ProtocolError(f"request: cmd is {reprlib.repr(cmd)}, expected one of {', '.join(COMMANDS)}")
    field = COMMANDS[cmd]
    taken = set() if field is None else {field.name}
    if unknown := fields.keys() - {"v", "cmd"} - taken:
        raise ProtocolError(f"request: {cmd} takes no field {reprlib.repr(min(unknown))}")
    if field is None:
        return Request(cmd)
    if field.name not in fields:
        raise ProtocolError(f"request: {cmd} needs the field {field.name!r}")
    value = fields[field.name]
    if not field.fits(value):
        raise ProtocolError(f"request: {field.name} is {reprlib.repr(value)}, expected {field.words}")
    return Request(cmd, value)


def encode_reply(state: Mapping[str, object], **more: object) -> bytes:
    """Return the reply to a request that was carried out."""
    return _pack({"ok": True, "state": state, **more})


def encode_refusal(sentence: str) -> bytes:
    """Return the reply to a request that was not carried out."""
    return _pack({"ok": False, "error": sentence})


def decode_reply(payload: bytes) -> dict[str, object]:
    """Read a reply.

    Raises
    ------
    ProtocolError
        If it is no msgpack map with ``ok``, or of another version.
    """
    fields = decode_payload("reply", payload)
    if not isinstance(fields.get("ok"), bool):
        raise ProtocolError(f"reply: ok is {reprlib.repr(fields.get('ok'))}, expected true or false")
    return fields


def _pack(fields: Mapping[str, object]) -> bytes:
    return encode("control", fields)[1]
