"""Both sides of every limit that a message has."""

import msgpack
import numpy as np
import pytest

from limbcal.errors import ProtocolError
from protocol.message import (
    MAX_PAYLOAD_BYTES,
    PLOT,
    decode,
    decode_array,
    decode_payload,
    encode,
    encode_array,
    fields_of,
)


@pytest.mark.parametrize(
    ("topic", "said"), [("t" * 60, "t" * 60), ("t" * 61, "t" * 57 + "..."), ("t" * 500, "t" * 57 + "...")]
)
def test_a_topic_is_said_in_sixty_characters(topic: str, said: str) -> None:
    for broken in (lambda: fields_of(topic, 7), lambda: decode_payload(topic, b"\xc1")):
        with pytest.raises(ProtocolError) as caught:
            broken()
        assert str(caught.value).startswith(f"{said}: payload is")


@pytest.mark.parametrize("length", [57, 58, 59, 500])
def test_what_was_found_is_said_in_sixty_characters(length: int) -> None:
    with pytest.raises(ProtocolError) as caught:
        fields_of("t", {"v": list(range(6)) * length, "x": 1})
    assert len(str(caught.value)) <= len("t: message version is , expected 1") + 60
    with pytest.raises(ProtocolError, match=r"expected bytes"):
        decode_array({"dtype": "<f8", "shape": [1], "data": "x"})


def test_what_is_sixty_characters_long_is_said_in_full() -> None:
    for value in (10**39, 10**58, 10**59):  # numbers of more than forty digits are shortened by their middle
        with pytest.raises(ProtocolError) as caught:
            fields_of("t", {"v": value})
        found = str(caught.value).removeprefix("t: message version is ").removesuffix(", expected 1")
        assert len(found) <= 60 and found.startswith("1000")


@pytest.mark.parametrize(("more", "fits"), [(0, True), (1, False)])
def test_a_payload_is_of_16_mib_at_most(more: int, fits: bool) -> None:
    assert MAX_PAYLOAD_BYTES == 16 * 2**20
    room = MAX_PAYLOAD_BYTES - len(msgpack.packb({"x": b"", "v": 1})) - 3  # a long binary's length has five bytes
    data = bytes(room + more)
    if fits:
        (_, payload) = encode("t", {"x": data})
        assert len(payload) == MAX_PAYLOAD_BYTES and len(decode([b"t", payload])[1]["x"]) == room
        return
    with pytest.raises(ProtocolError, match=f"payload of {MAX_PAYLOAD_BYTES + 1} bytes, expected at most"):
        encode("t", {"x": data})
    with pytest.raises(ProtocolError, match=f"payload of {MAX_PAYLOAD_BYTES + 1} bytes, expected at most"):
        decode([b"t", msgpack.packb({"x": data, "v": 1})])


def nested(depth: int, kind: str) -> object:
    value: object = 1
    for _ in range(depth):
        value = [value] if kind == "list" else {"a": value}
    return value


@pytest.mark.parametrize("kind", ["list", "map"])
@pytest.mark.parametrize(("depth", "fits"), [(7, True), (8, False)])
def test_values_are_nested_eight_deep_at_most(kind: str, depth: int, fits: bool) -> None:
    value = nested(depth, kind)
    if fits:
        assert fields_of("t", {"v": 1, "x": value})["x"] == value
        return
    with pytest.raises(ProtocolError, match="t: maps and lists nested more than 8 deep"):
        fields_of("t", {"v": 1, "x": value})


@pytest.mark.parametrize(
    ("shape", "fits"), [([2, 1, 1, 1], True), ([2, 1, 1, 1, 1], False), ([2], True), ([-1, -2], False)]
)
def test_an_array_has_four_dimensions_at_most(shape: list[int], fits: bool) -> None:
    fields = {"dtype": "<i2", "shape": shape, "data": b"\x01\x00\xff\xff"}
    if fits:
        assert decode_array(fields).ravel().tolist() == [1, -1]
        return
    with pytest.raises(ProtocolError, match="expected up to 4 lengths"):
        decode_array(fields)


@pytest.mark.parametrize("length", [0, 2**24])
def test_a_side_is_from_none_to_16_mi(length: int) -> None:
    assert decode_array({"dtype": "<f8", "shape": [length, 0], "data": b""}).shape == (length, 0)
    with pytest.raises(ProtocolError, match="lengths"):
        decode_array({"dtype": "<f8", "shape": [2**24 + 1, 0], "data": b""})


def test_any_byte_but_zero_is_true() -> None:
    found = decode_array({"dtype": "|b1", "shape": [4], "data": b"\x00\x01\x02\xff"})
    assert found.tolist() == [False, True, True, True] and found.dtype == bool


@pytest.mark.parametrize("dtype", ["<f8", "<f4", "<i8", "<i4", "<i2", "|b1"])
def test_an_array_is_sent_in_little_endian_and_in_rows(dtype: str) -> None:
    array = np.array([[0, 1, 2], [3, 4, 5]]).astype(dtype)
    for given in (array, array.astype(np.dtype(dtype).newbyteorder(">")), np.asfortranarray(array)):
        assert encode_array(given) == {"dtype": dtype, "shape": [2, 3], "data": array.tobytes()}


def test_rows_for_plots_have_the_number_of_their_message() -> None:
    assert msgpack.unpackb(encode(PLOT, {"rows": [{"ts": 1.0}]})[1]) == [{"ts": 1.0, "v": 1, "seq": 0}]
    assert msgpack.unpackb(encode(PLOT, {})[1]) == []
    assert decode(encode(PLOT, {})) == (PLOT, {"v": 1, "rows": []})
