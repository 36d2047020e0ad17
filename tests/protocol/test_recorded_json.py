"""What is recorded as JSON is strict, and nothing else is read back."""

import json
import math

import numpy as np
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


def test_rows_lie_as_far_apart_as_their_times() -> None:
    rows = [{"ts": float(ts)} for ts in (0, 2000)]
    found = json_messages(PLOT, encode(PLOT, {"rows": rows})[1], 0)
    assert [t_ns for _, t_ns in found] == [0, 2000 * 10**9]


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


def test_rows_without_times_are_of_one_time() -> None:
    found = json_messages(PLOT, encode(PLOT, {"rows": [{"q1": 1.0}, {"q1": 2.0}]})[1], 5)
    assert [(json.loads(data), t_ns) for data, t_ns in found] == [
        ({"q1": 1.0, "v": 1, "seq": 0}, 5),
        ({"q1": 2.0, "v": 1, "seq": 0}, 5),
    ]
    (later,) = json_messages(PLOT, encode(PLOT, {"rows": [{"ts": 3.0}]})[1], 5)
    assert later[1] == 5


def test_a_payload_has_no_more_than_a_message() -> None:
    whole = b'{"v": 1}'
    padded = whole + b" " * (2**24 - len(whole))
    assert decode_json(HEALTH, padded) == {"v": 1}
    with pytest.raises(ProtocolError, match="payload of 16777217 bytes, expected at most 16777216"):
        decode_json(HEALTH, padded + b" ")


def test_what_is_not_finite_is_null_however_deep() -> None:
    fields = {"a": [1.0, math.nan, {"b": -math.inf}], "c": np.array([1.0, math.inf]), "n": None, "flag": True}
    ((data, _),) = json_messages(HEALTH, encode(HEALTH, fields)[1], 0)
    assert json.loads(data) == {"a": [1.0, None, {"b": None}], "c": [1.0, None], "n": None, "flag": True, "v": 1}
