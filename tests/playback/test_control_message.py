"""Requests and replies."""

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import ProtocolError
from playback.control_message import (
    COMMANDS,
    REQUEST_LIMIT,
    Request,
    decode_reply,
    decode_request,
    encode_refusal,
    encode_reply,
    encode_request,
)

plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**40), 2**40) | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=4),
    max_leaves=10,
)
requests = st.dictionaries(st.sampled_from(["v", "cmd", "trial", "x"]) | st.text(max_size=3), plain)


@pytest.mark.parametrize(
    "request_",
    [
        *(Request(cmd) for cmd, field in COMMANDS.items() if field is None),
        *(Request("load", 17), Request("seek", 1.5), Request("speed", 2), Request("loop", True)),
        *(Request("step", -3), Request("seek", 0)),
    ],
)
def test_requests_come_back(request_: Request) -> None:
    assert decode_request([encode_request(request_)]) == request_


def test_replies_come_back() -> None:
    state = {"playing": True, "trials": [1, 2], "lateness_ms": {"p50": None}}
    assert decode_reply(encode_reply(state)) == {"v": 1, "ok": True, "state": state}
    assert decode_reply(encode_refusal("no")) == {"v": 1, "ok": False, "error": "no"}


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"v": 2, "cmd": "play"}, "version is 2, expected 1"),
        ({"cmd": "play"}, "version is None, expected 1"),
        ({"v": True, "cmd": "play"}, "version is True"),
        ({"v": 1}, "cmd is None, expected one of play, pause, stop, seek, speed, loop, step"),
        ({"v": 1, "cmd": "dance"}, "cmd is 'dance', expected one of play"),
        ({"v": 1, "cmd": ["play"]}, r"cmd is \['play'\]"),
        ({"v": 1, "cmd": "x" * 1000}, "cmd is 'xxx"),
        ({"v": 1, "cmd": "play", "trail": 1}, "play takes no field 'trail'"),
        ({"v": 1, "cmd": "load"}, "load needs the field 'trial'"),
        ({"v": 1, "cmd": "load", "trial": True}, "trial is True, expected a whole number"),
        ({"v": 1, "cmd": "load", "trial": "1"}, "trial is '1'"),
        ({"v": 1, "cmd": "load", "trial": None}, "trial is None"),
        ({"v": 1, "cmd": "load", "trial": 2**63}, "trial is 9223372036854775808, expected a whole number from"),
        ({"v": 1, "cmd": "seek"}, "seek needs the field 'position_s'"),
        ({"v": 1, "cmd": "seek", "position_s": float("nan")}, "position_s is nan, expected a number of seconds"),
        ({"v": 1, "cmd": "seek", "trial": 1}, "seek takes no field 'trial'"),
        ({"v": 1, "cmd": "speed", "speed": "2"}, "speed is '2', expected a number"),
        ({"v": 1, "cmd": "loop", "loop": 1}, "loop is 1, expected true or false"),
        ({"v": 1, "cmd": "step", "frames": 1.0}, "frames is 1.0, expected a whole number"),
        ([1, "play"], "is a list, expected a map"),
        (7, "is an int, expected a map"),
    ],
)
def test_a_wrong_request_is_refused_in_one_short_sentence(fields: object, said: str) -> None:
    with pytest.raises(ProtocolError, match=said) as caught:
        decode_request([msgpack.packb(fields)])
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


def test_a_request_is_one_part_of_bounded_size() -> None:
    with pytest.raises(ProtocolError, match="2 parts, expected 1"):
        decode_request([b"limb/play", msgpack.packb({"v": 1, "cmd": "play"})])
    big = msgpack.packb({"v": 1, "cmd": "play", "x": bytes(REQUEST_LIMIT)})
    with pytest.raises(ProtocolError, match=f"{len(big)} bytes, expected at most {REQUEST_LIMIT}"):
        decode_request([big])


@given(st.lists(st.binary(max_size=200) | requests.map(msgpack.packb), max_size=3))
def test_whatever_comes_is_a_request_or_refused(parts: list[bytes]) -> None:
    try:
        request = decode_request(parts)
    except ProtocolError:
        return
    assert request.cmd in COMMANDS


@pytest.mark.parametrize("depth", [10, 900, 1000, 5000])
@pytest.mark.parametrize("head", [{"v": 1, "cmd": "play"}, {"v": 1}, {"cmd": "play"}])
def test_deep_nesting_is_refused(depth: int, head: dict[str, object]) -> None:
    name = "v" if "v" not in head else "cmd" if "cmd" not in head else "x"
    packed = msgpack.packb(head)
    payload = bytes([packed[0] + 1]) + packed[1:] + msgpack.packb(name) + b"\x91" * depth + b"\x01"
    with pytest.raises(ProtocolError):
        decode_request([payload])


@pytest.mark.parametrize("payload", [b"", b"\xc1", msgpack.packb({"v": 1}), msgpack.packb({"v": 1, "ok": 1})])
def test_what_is_no_reply_is_refused(payload: bytes) -> None:
    with pytest.raises(ProtocolError, match="^reply: "):
        decode_reply(payload)
