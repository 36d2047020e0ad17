"""Requests and replies of the control socket: msgpack maps with ``"v": 1``."""

from collections.abc import Mapping
from dataclasses import dataclass

import msgpack

from limbcal.errors import ProtocolError

VERSION = 1
REQUEST_LIMIT = 64 * 1024  # bytes; a request is some tens

#: Every command with the fields that it takes besides v and cmd.
COMMANDS: Mapping[str, frozenset[str]] = {
    "play": frozenset(),
    "stop": frozenset(),
    "state": frozenset(),
    "list": frozenset(),
    "load": frozenset({"trial"}),
}


@dataclass(frozen=True)
class Request:
    """What a client asks for; ``trial`` comes with `load` only."""

    cmd: str
    trial: int | None = None


def encode_request(request: Request) -> bytes:
    """Return a request as it travels."""
    fields: dict[str, object] = {"v": VERSION, "cmd": request.cmd}
    if request.trial is not None:
        fields["trial"] = request.trial
    return bytes(msgpack.packb(fields))


def decode_request(payload: bytes) -> Request:
    """Read a request.

    Raises
    ------
    ProtocolError
        If the payload is too big, is no msgpack map, is of another version, or asks for what there is not.
    """
    if len(payload) > REQUEST_LIMIT:
        raise ProtocolError(f"the request has {len(payload)} bytes, expected at most {REQUEST_LIMIT}")
    fields = _unpack_map(payload, "the request")
    cmd = fields.get("cmd")
    if not isinstance(cmd, str) or cmd not in COMMANDS:
        raise ProtocolError(f"cmd is {_short(cmd)}, expected one of {', '.join(COMMANDS)}")
    if unknown := fields.keys() - {"v", "cmd"} - COMMANDS[cmd]:
        raise ProtocolError(f"{cmd} takes no field {_short(min(unknown))}")
    if missing := COMMANDS[cmd] - fields.keys():
        raise ProtocolError(f"{cmd} lacks the field {min(missing)!r}")
    trial = fields.get("trial")
    if cmd == "load" and type(trial) is not int:  # a bool is no number of a trial
        raise ProtocolError(f"trial is {_short(trial)}, expected a whole number")
    return Request(cmd, trial if type(trial) is int else None)


def encode_reply(state: Mapping[str, object], **more: object) -> bytes:
    """Return the reply to a request that was carried out."""
    return bytes(msgpack.packb({"v": VERSION, "ok": True, "state": state, **more}))


def encode_refusal(sentence: str) -> bytes:
    """Return the reply to a request that was not carried out."""
    return bytes(msgpack.packb({"v": VERSION, "ok": False, "error": sentence}))


def decode_reply(payload: bytes) -> dict[str, object]:
    """Read a reply.

    Raises
    ------
    ProtocolError
        If it is no msgpack map with ``ok``, or of another version.
    """
    fields = _unpack_map(payload, "the reply")
    if not isinstance(fields.get("ok"), bool):
        raise ProtocolError(f"ok is {_short(fields.get('ok'))} in the reply, expected true or false")
    return fields


def _unpack_map(payload: bytes, what: str) -> dict[str, object]:
    try:
        fields = msgpack.unpackb(payload)
    except (ValueError, TypeError, msgpack.UnpackException) as error:
        raise ProtocolError(f"{what} is not msgpack, expected one msgpack map") from error
    if not isinstance(fields, dict):
        raise ProtocolError(f"{what} is a {type(fields).__name__}, expected a msgpack map")
    if type(fields.get("v")) is not int or fields["v"] != VERSION:
        raise ProtocolError(f"v is {_short(fields.get('v'))} in {what}, expected {VERSION}")
    odd = [key for key in fields if not isinstance(key, str)]
    if odd:
        raise ProtocolError(f"{what} has the key {_short(odd[0])}, expected strings")
    return fields


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
