"""Requests and replies of the control socket: msgpack maps with ``"v": 1``."""

import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from limbcal.errors import ProtocolError
from protocol.message import decode_payload, encode

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
    fields = {"cmd": request.cmd} | ({} if request.trial is None else {"trial": request.trial})
    return _pack(fields)


def decode_request(parts: Sequence[bytes]) -> Request:
    """Read a request from the parts of its message that follow the address.

    Raises
    ------
    ProtocolError
        If it is not one part, too big, no msgpack map, of another version, or asks for what there is not.
    """
    if len(parts) != 1:
        raise ProtocolError(f"request: {len(parts)} parts, expected 1")
    if len(parts[0]) > REQUEST_LIMIT:
        raise ProtocolError(f"request: {len(parts[0])} bytes, expected at most {REQUEST_LIMIT}")
    fields = decode_payload("request", parts[0])
    cmd = fields.get("cmd")
    if not isinstance(cmd, str) or cmd not in COMMANDS:
        raise ProtocolError(f"request: cmd is {reprlib.repr(cmd)}, expected one of {', '.join(COMMANDS)}")
    if unknown := fields.keys() - {"v", "cmd"} - COMMANDS[cmd]:
        raise ProtocolError(f"request: {cmd} takes no field {reprlib.repr(min(unknown))}")
    if missing := COMMANDS[cmd] - fields.keys():
        raise ProtocolError(f"request: {cmd} needs the field {min(missing)!r}")
    if cmd != "load":
        return Request(cmd)
    trial = fields["trial"]
    if not isinstance(trial, int) or isinstance(trial, bool):
        raise ProtocolError(f"request: trial is {reprlib.repr(trial)}, expected a whole number")
    return Request(cmd, trial)


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
