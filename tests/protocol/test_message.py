"""Messages: round trips, and everything that is not one."""

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from limbcal.errors import ProtocolError
from protocol.message import (
    FRAMES,
    HEALTH,
    MAX_DEPTH,
    MAX_PAYLOAD_BYTES,
    PLOT,
    TOPICS,
    decode,
    decode_array,
    encode,
    encode_array,
    fields_of,
)

dtypes = st.sampled_from(["<f8", "<f4", "<i8", "<i4", "<i2", "|b1", ">f8", ">i4"])
arrays = dtypes.flatmap(lambda dtype: hnp.arrays(dtype, hnp.array_shapes(min_dims=0, max_dims=4, min_side=0)))
names = st.text(max_size=10).filter(lambda name: name not in ("v", "dtype", "shape", "data"))
plain = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text(max_size=10)
    | st.binary(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(names, inner, max_size=3),
    max_leaves=8,
).filter(lambda value: _depth(value) < MAX_DEPTH)


def _depth(value):
    if isinstance(value, dict):
        return 1 + max(map(_depth, value.values()), default=0)
    return 1 + max(map(_depth, value), default=0) if isinstance(value, list) else 0


def packed(document):
    return [b"limb/frames", msgpack.packb(document)]


@given(arrays)
def test_array_round_trip(array):
    fields = encode_array(array)
    again = decode_array(fields)
    assert fields["dtype"][0] in "<|"
    assert again.shape == array.shape
    assert again.dtype == array.dtype.newbyteorder("=")
    assert again.flags.writeable and again.flags.aligned
    np.testing.assert_array_equal(again, array)


def test_a_transposed_array_keeps_its_order():
    array = np.arange(6.0).reshape(2, 3).T
    np.testing.assert_array_equal(decode_array(encode_array(array)), array)


@pytest.mark.parametrize("array", [np.array(["x"]), np.array([None]), np.zeros(2, complex), np.zeros((1,) * 5)])
def test_arrays_of_other_kinds_are_not_sent(array):
    with pytest.raises(ProtocolError, match="array of"):
        encode_array(array)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"dtype": "|O"}, "dtype is '|O'"),
        ({"dtype": ">f8"}, "dtype is '>f8'"),
        ({"dtype": ["<f8"]}, "dtype is"),
        ({"shape": [3]}, "16 bytes, expected 24"),
        ({"shape": [-1]}, "shape is"),
        ({"shape": [2.0]}, "shape is"),
        ({"shape": [True, 2]}, "shape is"),
        ({"shape": [1, 1, 1, 1, 2]}, "shape is"),
        ({"shape": 2}, "shape is"),
        ({"shape": [2**40, 0]}, "shape is"),
        ({"data": "text"}, "data is a str"),
        ({"data": b"123"}, "3 bytes, expected 16"),
    ],
)
def test_an_array_that_does_not_fit_is_refused(change, said):
    fields = {**encode_array(np.zeros(2)), **change}
    with pytest.raises(ProtocolError) as error:
        decode(packed({"v": 1, "q": fields}))
    assert said in str(error.value)
    assert "limb/frames" in str(error.value)


def test_an_empty_array_of_great_sides_is_refused():
    with pytest.raises(ProtocolError, match="shape is"):
        decode_array({"dtype": "<f8", "shape": [0, 2**24, 2**24, 2**24], "data": b""})


@given(
    st.sampled_from(["<f8", "<f4", "<i2", "|b1", "|O"]),
    st.lists(st.integers(-1, 2**24) | st.integers(0, 3), max_size=5),
    st.binary(max_size=48),
)
def test_an_array_is_what_it_says_or_refused(dtype, shape, data):
    try:
        array = decode_array({"dtype": dtype, "shape": shape, "data": data})
    except ProtocolError:
        return
    assert array.shape == tuple(shape)
    assert array.nbytes == len(data)


@given(st.text(max_size=20).filter(lambda topic: topic != PLOT), st.dictionaries(names, plain, max_size=5))
def test_message_round_trip(topic, fields):
    parts = encode(topic, fields)
    assert len(parts) == 2
    assert decode(parts) == (topic, {**fields, "v": 1})


def test_arrays_inside_of_maps_and_lists_are_restored():
    fields = {"a": np.arange(3), "more": {"b": [np.ones((2, 2), np.float32)]}, "n": np.int64(7), "x": np.True_}
    _, again = decode(encode(FRAMES, fields))
    np.testing.assert_array_equal(again["a"], fields["a"])
    np.testing.assert_array_equal(again["more"]["b"][0], fields["more"]["b"][0])
    assert again["more"]["b"][0].dtype == np.float32
    assert (again["n"], again["x"]) == (7, True)


def test_another_program_needs_only_msgpack_and_numpy():
    topic, payload = encode(FRAMES, {"q": np.array([[0.1, 0.2], [0.3, 0.4]])})
    fields = msgpack.unpackb(payload)
    assert topic == b"limb/frames"
    assert fields["v"] == 1
    assert set(fields["q"]) == {"dtype", "shape", "data"}
    q = np.frombuffer(fields["q"]["data"], fields["q"]["dtype"]).reshape(fields["q"]["shape"])
    np.testing.assert_array_equal(q, [[0.1, 0.2], [0.3, 0.4]])


def test_plot_is_an_array_of_flat_maps_on_the_wire():
    rows = [{"ts": 0.01, "q1": np.float64(0.5)}, {"ts": 0.02, "q1": 0.6}]
    parts = encode(PLOT, {"rows": rows, "seq": 9, "arm": "dd-arm", "run": "x"})
    assert msgpack.unpackb(parts[1]) == [
        {"ts": 0.01, "q1": 0.5, "v": 1, "seq": 9},
        {"ts": 0.02, "q1": 0.6, "v": 1, "seq": 9},
    ]
    assert decode(parts) == (PLOT, {"v": 1, "seq": 9, "rows": rows})


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ({"v": 1}, "expected an array of maps"),
        ([1], "expected a flat map of numbers"),
        ([{"v": 1, "ts": {}}], "expected a flat map of numbers"),
        ([{"ts": 1.0}], "version is None"),
        ([{"v": 2, "ts": 1.0}], "version is 2"),
    ],
)
def test_a_plot_of_another_kind_is_refused(document, said):
    with pytest.raises(ProtocolError, match=said):
        decode([PLOT.encode(), msgpack.packb(document)])


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ([], "message of 0 parts, expected 2"),
        ([b"limb/frames"], "message of 1 parts, expected 2"),
        ([b"limb/frames", b"\x80", b""], "message of 3 parts, expected 2"),
        ([b"\xff\xfe", b"\x80"], "expected UTF-8"),
        ([b"limb/frames", b""], "limb/frames: payload is not msgpack"),
        ([b"limb/frames", b"\xc1"], "payload is not msgpack"),
        ([b"limb/frames", b"\x80\x80"], "payload is not msgpack"),
        ([b"limb/frames", b"\xdd\xff\xff\xff\xff"], "payload is not msgpack"),
        ([b"limb/frames", b"\x91" * 5000], "payload is not msgpack"),
        ([b"limb/frames", b"cos\nsystem\n(S'true'\ntR."], "payload"),
        (packed([1, 2]), "payload is a list, expected a map"),
        (packed({}), "message version is None, expected 1"),
        (packed({"v": 2}), "message version is 2, expected 1"),
        (packed({"v": True}), "message version is True, expected 1"),
        (packed({"v": 1.0}), "message version is 1.0, expected 1"),
        (packed({"v": 1, b"x": 2}), "field name is b'x', expected a string"),
        (packed({"v": 1, "x": msgpack.ExtType(5, b"data")}), "extension type 5"),
        (packed({"v": 1, "x": msgpack.Timestamp(5)}), "found a Timestamp"),
        ([b"limb/frames", b"\x82\xa1v\x01\xa1x" + b"\x91" * 500 + b"\x01"], "nested more than"),
        ([b"limb/frames", bytes(MAX_PAYLOAD_BYTES + 1)], "bytes, expected at most"),
    ],
)
def test_what_is_no_message_is_said_in_one_sentence(parts, said):
    with pytest.raises(ProtocolError) as error:
        decode(parts)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


valid = encode(FRAMES, {"q": np.zeros((3, 2)), "n": 3, "names": ["a", "b"], "more": {"x": 1.0}})[1]


@st.composite
def mutilated(draw):
    payload = bytearray(valid)
    for _ in range(draw(st.integers(1, 4))):
        payload[draw(st.integers(0, len(payload) - 1))] = draw(st.integers(0, 255))
    return bytes(payload[: draw(st.integers(0, len(payload)))])


@given(
    st.one_of(
        st.lists(st.binary(max_size=60), max_size=4),
        st.tuples(st.sampled_from([topic.encode() for topic in TOPICS]), st.binary(max_size=60)),
        st.tuples(st.sampled_from([b"limb/frames", b"limb/plot"]), mutilated()),
        st.tuples(st.just(b"limb/plot"), st.binary(max_size=40).map(lambda tail: b"\x91\x82\xa1v\x01" + tail)),
    )
)
def test_decode_raises_only_protocol_errors(parts):
    try:
        topic, fields = decode(parts)
    except ProtocolError:
        return
    assert isinstance(topic, str)
    assert fields["v"] == 1


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (object(), "found an object, expected plain values and arrays"),
        ({1, 2}, "found a set, expected plain values and arrays"),
        (2**70, "found a whole number of 71 bits, expected at most 64"),
        (np.array([object()]), "array of object"),
    ],
)
def test_what_cannot_be_sent_is_said(value, said):
    with pytest.raises(ProtocolError, match=said):
        encode(HEALTH, {"x": value})


def test_a_version_nested_a_thousand_deep_is_refused_like_any_other():
    nested: object = 1
    for _ in range(900):
        nested = [nested]
    with pytest.raises(ProtocolError, match="limb/frames"):
        decode([b"limb/frames", msgpack.packb({"v": nested})])


@pytest.mark.parametrize("wrap", [lambda inner: [inner], lambda inner: {"a": inner}])
def test_the_deepest_that_may_be_is_read_and_one_deeper_is_not(wrap):
    value = 1
    for _ in range(MAX_DEPTH - 1):
        value = wrap(value)
    assert decode(encode(HEALTH, {"x": value}))[1]["x"] == value
    with pytest.raises(ProtocolError, match=f"nested more than {MAX_DEPTH} deep"):
        decode(encode(HEALTH, {"x": wrap(value)}))


def test_sixteen_mebibytes_are_sent_and_read_and_no_more():
    assert (MAX_PAYLOAD_BYTES, MAX_DEPTH) == (2**24, 8)
    more = len(encode(HEALTH, {"x": bytes(100_000)})[1]) - 100_000
    parts = encode(HEALTH, {"x": bytes(MAX_PAYLOAD_BYTES - more)})
    assert len(parts[1]) == MAX_PAYLOAD_BYTES
    assert len(decode(parts)[1]["x"]) == MAX_PAYLOAD_BYTES - more
    with pytest.raises(ProtocolError, match="payload of 16777217 bytes, expected at most 16777216"):
        encode(HEALTH, {"x": bytes(MAX_PAYLOAD_BYTES - more + 1)})


@pytest.mark.parametrize(("length", "said"), [(60, "t" * 60), (61, "t" * 57 + "..."), (500, "t" * 57 + "...")])
def test_long_topics_are_told_in_short(length, said):
    for payload in (b"\xc1", msgpack.packb([1])):
        with pytest.raises(ProtocolError) as error:
            decode([b"t" * length, payload])
        assert str(error.value).startswith(f"{said}: payload")


@pytest.mark.parametrize(("side", "shape"), [(2**24, (2**24, 0)), (2**24 + 1, None)])
def test_a_side_is_no_longer_than_a_payload(side, shape):
    fields = {"dtype": "<f8", "shape": [side, 0], "data": b""}
    if shape is None:
        with pytest.raises(ProtocolError, match="expected up to 4 lengths"):
            decode_array(fields)
    else:
        assert decode_array(fields).shape == shape


@pytest.mark.parametrize("byte", [1, 2, 255])
def test_a_bool_is_any_byte_but_nought(byte):
    found = decode_array({"dtype": "|b1", "shape": [2], "data": bytes([0, byte])})
    assert found.tolist() == [False, True] and found.dtype == np.bool_


def test_a_plot_without_a_number_has_nought():
    assert msgpack.unpackb(encode(PLOT, {"rows": [{"ts": 1.0}]})[1]) == [{"ts": 1.0, "v": 1, "seq": 0}]
    assert decode(encode(PLOT, {})) == (PLOT, {"v": 1, "rows": []})
    with pytest.raises(ProtocolError, match="field name is b'x', expected a string"):
        decode([PLOT.encode(), msgpack.packb([{"v": 1, b"x": 1.0}])])


@pytest.mark.parametrize("length", [57, 58, 59, 500])
def test_what_was_found_is_said_in_sixty_characters(length: int) -> None:
    with pytest.raises(ProtocolError) as caught:
        fields_of("t", {"v": list(range(6)) * length, "x": 1})
    assert len(str(caught.value)) <= len("t: message version is , expected 1") + 60
    with pytest.raises(ProtocolError, match=r"expected bytes"):
        decode_array({"dtype": "<f8", "shape": [1], "data": "x"})


@pytest.mark.parametrize("dtype", ["<f8", "<f4", "<i8", "<i4", "<i2", "|b1"])
def test_an_array_is_sent_in_little_endian_and_in_rows(dtype: str) -> None:
    array = np.array([[0, 1, 2], [3, 4, 5]]).astype(dtype)
    for same in (array, array.astype(np.dtype(dtype).newbyteorder(">")), np.asfortranarray(array)):
        assert encode_array(same) == {"dtype": dtype, "shape": [2, 3], "data": array.tobytes()}
