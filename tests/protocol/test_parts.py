"""No more parts and bytes of a message are kept than there may be; all of it is read."""

from collections.abc import Iterator

import pytest
import zmq

from protocol.parts import MESSAGE_BYTES, MOST_PARTS, receive_parts
from protocol.peers import PART_OVERHEAD
from tests.patience import PATIENCE_MS

Pair = tuple["zmq.Socket[bytes]", "zmq.Socket[bytes]"]


@pytest.fixture
def pair() -> Iterator[Pair]:
    with zmq.Context() as context, context.socket(zmq.PAIR) as one, context.socket(zmq.PAIR) as other:
        one.bind("inproc://parts")
        other.connect("inproc://parts")
        yield one, other


def test_parts_beyond_the_most_are_read_and_forgotten(pair: Pair) -> None:
    sending, receiving = pair
    sending.send_multipart([b"%d" % k for k in range(MOST_PARTS + 5)])
    sending.send(b"next")
    assert receiving.poll(PATIENCE_MS)
    received = receive_parts(receiving, 1000)
    assert received.parts == [b"%d" % k for k in range(MOST_PARTS)]
    assert received.first.bytes == b"0"
    sizes = [len(b"%d" % k) for k in range(MOST_PARTS + 5)]
    assert received.n_byte == sum(sizes) + len(sizes) * PART_OVERHEAD
    assert receive_parts(receiving, 1000).parts == [b"next"]


def test_a_part_that_would_go_beyond_the_bytes_is_kept_empty(pair: Pair) -> None:
    sending, receiving = pair
    sending.send_multipart([b"a" * 6, b"b" * 5, b"c" * 4])
    assert receiving.poll(PATIENCE_MS)
    assert receive_parts(receiving, 10).parts == [b"a" * 6, b"", b"c" * 4]


def test_nothing_is_waited_for(pair: Pair) -> None:
    with pytest.raises(zmq.Again):
        receive_parts(pair[1], 10)


def test_eight_parts_are_kept_and_4096_bytes_beside_a_payload() -> None:
    assert (MOST_PARTS, MESSAGE_BYTES, PART_OVERHEAD) == (8, 2**24 + 4096, 64)


def test_the_last_byte_that_fits_is_kept(pair: Pair) -> None:
    sending, receiving = pair
    for more, kept in ((4, [b"a" * 6, b"b" * 4]), (5, [b"a" * 6, b""])):
        sending.send_multipart([b"a" * 6, b"b" * more])
        assert receiving.poll(PATIENCE_MS)
        received = receive_parts(receiving, 10)
        assert (received.parts, received.n_byte) == (kept, 6 + more + 2 * 64)
