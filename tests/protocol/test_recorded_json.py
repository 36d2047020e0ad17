"""What is recorded as JSON is strict, and nothing else is read back."""

import json
import math

import pytest

from limbcal.errors import ProtocolError
from protocol.message import HEALTH, PLOT, TRIAL, encode
from protocol.recorded_json import decode_json, json_messages, recorded_schema


def test_rows_become_messages_of_their_own() -> None:
    rows = [{"ts": 7.0, "q1": 1.0}, {"ts": 7.25, "q1": math.inf}]
    found = json_messages(PLOT, encode(PLOT, {"rows": rows, "seq": 3})[1], 10**9)
    assert [(json.loads(data), t_ns) for data, t_ns in found] == [
        ({"ts": 7.0, "q1": 1.0, "v": 1, "seq": 3}, 10**9),
        ({"ts": 7.25, "q1": None, "v": 1, "seq": 3}, 10**9 + 250_000_000),
    ]
    described = json.loads(recorded_schema(PLOT, found[0][0]))
    assert described["type"] == "object" and set(described["properties"]) == {"ts", "v", "seq", "q1"}
    assert decode_json(PLOT, found[0][0])["rows"] == [rows[0]]


def test_a_message_comes_back() -> None:
    fields = {"trial": 2, "t_ns": 2**60, "state": "end", "role": "learn", "seq": 1}
    ((data, t_ns),) = json_messages(TRIAL, encode(TRIAL, fields)[1], 5)
    assert (decode_json(TRIAL, data), t_ns) == ({**fields, "v": 1}, 5)


@pytest.mark.parametrize(
    ("payload", "said"),
    [
        (b'{"v": 1, "samples": NaN}', "found NaN"),
        (b'{"v": 1', "not JSON"),
        (b"\xff", "not JSON"),
        (b"[" * 100_000, "not JSON"),
        (b'{"v": 2}', "version is 2"),
        (b"[1]", "expected a map"),
    ],
)
def test_what_is_none_is_refused(payload: bytes, said: str) -> None:
    with pytest.raises(ProtocolError, match=said):
        decode_json(HEALTH, payload)


def test_a_row_that_is_none_is_refused() -> None:
    for payload in (b"[]", b'{"v": 1, "q1": "far"}'):
        with pytest.raises(ProtocolError):
            decode_json(PLOT, payload)
