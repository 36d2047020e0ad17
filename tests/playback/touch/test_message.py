"""What devices say: read exactly, or refused in one sentence."""

import msgpack
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from limbcal.errors import ProtocolError
from playback.touch.message import Command, Input, decode_input, encode_input
from protocol.message import encode_array

UNHURRIED = settings(deadline=None)  # the first call may compile


def test_an_input_is_read_as_it_was_written() -> None:
    fields = {"position": [0.1, 2, -3.5], "velocity": [0, 0, 1.0], "joint": 2, "point": [0.1, 0.0, 0.0], "seq": 7}
    said = decode_input(encode_input({**fields, "orientation": [0.5, 0.5, 0.5, 0.5]}), 3)
    assert isinstance(said, Input)
    assert said.position.tolist() == [0.1, 2.0, -3.5]
    assert said.velocity.tolist() == [0.0, 0.0, 1.0]
    assert (said.joint, said.point, said.seq) == (2, (0.1, 0.0, 0.0), 7)
    np.testing.assert_allclose(said.orientation, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-15)
    bare = decode_input(encode_input({"position": np.array([1.0, 2.0, 3.0])}), 3)
    assert (bare.position.tolist(), bare.velocity, bare.joint) == ([1.0, 2.0, 3.0], None, None)


@pytest.mark.parametrize("seed", range(3))
def test_an_orientation_is_the_turn_of_its_quaternion(seed: int) -> None:
    turn = Rotation.random(rng=np.random.default_rng(seed))
    quaternion = 1.0001 * turn.as_quat(scalar_first=True)  # rounded, as devices send it
    said = decode_input(encode_input({"position": [0, 0, 0], "orientation": quaternion}), 3)
    np.testing.assert_allclose(said.orientation, turn.as_matrix(), atol=1e-12)


def test_the_last_joint_and_the_farthest_place_are_let_in() -> None:
    said = decode_input(encode_input({"position": [1e3, -1e3, 0], "joint": 2, "seq": 2**63 - 1}), 2)
    assert (said.position.tolist(), said.joint, said.seq) == ([1e3, -1e3, 0.0], 2, 2**63 - 1)


def test_a_command_is_read_as_it_was_written() -> None:
    said = decode_input(encode_input({"cmd": "hold", "q": [0.1, 0.2], "seq": 1}), 2)
    assert isinstance(said, Command)
    assert (said.cmd, said.q.tolist(), said.seq) == ("hold", [0.1, 0.2], 1)
    assert decode_input(encode_input({"cmd": "free"}), 2) == Command("free")


ARRAY = encode_array(np.array([0.0, np.inf, 0.0]))
BAD = [
    (b"", "not msgpack"),
    (b"\xc1", "not msgpack"),
    (msgpack.packb([1, 2]), "expected a map"),
    (msgpack.packb({"v": 2, "position": [0, 0, 0]}), "version is 2"),
    (msgpack.packb({"v": 1}), "'position' is missing"),
    (msgpack.packb({"v": 1, "position": [0, 0]}), "expected 3 numbers"),
    (msgpack.packb({"v": 1, "position": "abc"}), "expected 3 numbers"),
    (msgpack.packb({"v": 1, "position": [0, 0, True]}), "has True in it"),
    (msgpack.packb({"v": 1, "position": [0, 0, float("nan")]}), "has nan in it"),
    (msgpack.packb({"v": 1, "position": [0, 0, float("inf")]}), "has inf in it"),
    (msgpack.packb({"v": 1, "position": ARRAY}), "has inf in it"),
    (msgpack.packb({"v": 1, "position": [0, 0, 1e6]}), "within ±1000"),
    (msgpack.packb({"v": 1, "position": [0, 0, 0], "joint": 0}), "joint is 0, expected a whole number 1 to 2"),
    (msgpack.packb({"v": 1, "position": [0, 0, 0], "joint": 1.0}), "joint is 1.0"),
    (msgpack.packb({"v": 1, "position": [0, 0, 0], "orientation": [1, 1, 0, 0]}), "expected a unit quaternion"),
    (msgpack.packb({"v": 1, "position": [0, 0, 0], "force": [0, 0, 0]}), "no field 'force'"),
    (msgpack.packb({"v": 1, "cmd": "fly"}), "cmd is 'fly', expected one of state, hold, free, reset"),
    (msgpack.packb({"v": 1, "cmd": ["hold"]}), "cmd is ['hold']"),
    (msgpack.packb({"v": 1, "cmd": "free", "q": [0, 0]}), "free takes no q"),
    (msgpack.packb({"v": 1, "cmd": "hold", "q": [0, 0, 0]}), "expected 2 numbers"),
    (msgpack.packb({"v": 1, "position": [0, 0, 0], "x": bytes(5000)}), "expected at most 4096"),
]


@pytest.mark.parametrize(("payload", "said"), BAD)
def test_what_is_no_input_is_refused(payload: bytes, said: str) -> None:
    with pytest.raises(ProtocolError) as refused:
        decode_input(payload, 2)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@UNHURRIED
@given(st.binary(max_size=200))
def test_no_bytes_get_past(payload: bytes) -> None:
    try:
        said = decode_input(payload, 2)
    except ProtocolError:
        return
    assert_in_bounds(said)


numbers = st.one_of(st.floats(), st.integers(-(2**63), 2**64 - 1), st.booleans(), st.text(max_size=2))
vectors = st.one_of(st.lists(numbers, max_size=5), st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3), numbers)
fields = st.fixed_dictionaries(
    {"v": st.just(1)},
    optional={
        "position": vectors,
        "velocity": vectors,
        "point": vectors,
        "orientation": st.one_of(vectors, st.just([0.0, 0.6, 0.0, -0.8])),
        "joint": st.one_of(st.integers(-3, 4), numbers),
        "seq": numbers,
        "cmd": st.sampled_from(["state", "hold", "free", "reset", "fly"]),
        "q": st.one_of(vectors, st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=2)),
    },
)


@UNHURRIED
@given(fields)
def test_whatever_is_let_in_is_in_bounds(said: dict[str, object]) -> None:
    """Nearly right: most bytes at random are no message at all."""
    try:
        found = decode_input(msgpack.packb(said), 2)
    except ProtocolError:
        return
    assert_in_bounds(found)
    assert isinstance(found, Command) == ("cmd" in said)


def assert_in_bounds(said: Input | Command) -> None:
    """Hold what was let in against what the loop may be given: finite, bounded, of the right count."""
    assert said.seq is None or (type(said.seq) is int and 0 <= said.seq < 2**63)
    if isinstance(said, Command):
        assert said.cmd in ("state", "hold", "free", "reset")
        assert said.q is None or (said.q.shape == (2,) and np.abs(said.q).max() <= 1e4)
        assert said.q is None or said.cmd in ("hold", "reset")
        return
    assert isinstance(said, Input)
    assert said.position.shape == (3,) and np.abs(said.position).max() <= 1e3
    assert said.velocity is None or (said.velocity.shape == (3,) and np.abs(said.velocity).max() <= 1e4)
    assert said.joint is None or (type(said.joint) is int and 1 <= said.joint <= 2)
    assert said.point is None or (len(said.point) == 3 and max(map(abs, said.point)) <= 1e3)
    if said.orientation is not None:
        np.testing.assert_allclose(said.orientation @ said.orientation.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(said.orientation) > 0.0


PLACE: dict[str, object] = {"position": [0, 0, 0]}


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"velocity": [1e4, -1e4, 0]}, None),
        ({"velocity": [np.nextafter(1e4, 2e4), 0, 0]}, "within ±10000"),
        ({"position": [0, -np.nextafter(1e3, 2e3), 0]}, "within ±1000"),
        ({"point": [1e3, -1e3, 0]}, None),
        ({"point": [0, 0, 1001]}, "within ±1000"),
        ({"point": [0, 0]}, "point is [0, 0], expected 3 numbers"),
        ({"joint": 1}, None),
        ({"joint": 3}, "joint is 3, expected a whole number 1 to 2"),
        ({"joint": True}, "joint is True"),
        ({"seq": 0}, None),
        ({"seq": -1}, "seq is -1, expected a whole number 0 to 9223372036854775807"),
        ({"seq": 2**63}, "seq is 9223372036854775808"),
        ({"orientation": [1.0009, 0, 0, 0]}, None),
        ({"orientation": [0, 0.9991, 0, 0]}, None),
        ({"orientation": [1.0011, 0, 0, 0]}, "orientation has length 1.0011, expected a unit quaternion"),
        ({"orientation": [0, 0.9989, 0, 0]}, "orientation has length 0.9989"),
        ({"orientation": [2, 0, 0, 0]}, "orientation has length 2"),
        ({"orientation": [2.1, 0, 0, 0]}, "within ±2"),
        ({"orientation": [1, 0, 0]}, "expected 4 numbers"),
        ({"position": np.array([1, 2, 3])}, None),
        ({"position": np.array([True, False, True])}, "position is None, expected 3 numbers"),
    ],
)
def test_an_input_s_bounds_belong_to_it(fields: dict[str, object], said: str | None) -> None:
    payload = encode_input(PLACE | fields)
    if said is None:
        assert isinstance(decode_input(payload, 2), Input)
        return
    with pytest.raises(ProtocolError) as refused:
        decode_input(payload, 2)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"cmd": "hold", "q": [1e4, -1e4]}, None),
        ({"cmd": "reset", "q": [0, 0]}, None),
        ({"cmd": "reset"}, None),
        ({"cmd": "state"}, None),
        ({"cmd": "hold", "q": [0, 10001]}, "within ±10000"),
        ({"cmd": "state", "q": [0, 0]}, "state takes no q"),
        ({"cmd": "state", "seq": -1}, "seq is -1"),
        ({"cmd": "hold", "joint": 1}, "there is no field 'joint' here"),
        ({"q": [0, 0]}, "there is no field 'q' here"),
    ],
)
def test_a_command_s_bounds_belong_to_it(fields: dict[str, object], said: str | None) -> None:
    payload = encode_input(fields)
    if said is None:
        assert isinstance(decode_input(payload, 2), Command)
        return
    with pytest.raises(ProtocolError) as refused:
        decode_input(payload, 2)
    assert said in str(refused.value)


@pytest.mark.parametrize(("size", "said"), [(4096, "no field 'x'"), (4097, "4097 bytes, expected at most 4096")])
def test_an_input_has_4096_bytes_at_most(size: int, said: str) -> None:
    bare = len(msgpack.packb({"v": 1, "position": [0, 0, 0], "x": bytes(300)})) - 300
    payload = msgpack.packb({"v": 1, "position": [0, 0, 0], "x": bytes(size - bare)})
    assert len(payload) == size
    with pytest.raises(ProtocolError) as refused:
        decode_input(payload, 2)
    assert said in str(refused.value)
