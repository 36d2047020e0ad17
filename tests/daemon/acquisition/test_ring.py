"""What goes into the ring comes out in order, or is counted as dropped."""

from multiprocessing import get_context

import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.acquisition.ring import Chunk, Mark, Ring, ring_memory


def both_ends(capacity: int) -> tuple[Ring, Ring]:
    memory = ring_memory(get_context("spawn"), capacity)
    return Ring(memory), Ring(memory)


@given(st.lists(st.one_of(st.binary(max_size=90), st.none()), max_size=60), st.integers(64, 200))
def test_order_and_contents_survive_any_interleaving(steps: list[bytes | None], capacity: int) -> None:
    writer, reader = both_ends(capacity)
    accepted, taken, dropped = [], [], 0
    for stamp, step in enumerate(steps):
        if step is None:
            taken += reader.read()
        elif writer.write(step, stamp):
            accepted.append(Chunk(stamp, step))
        else:
            dropped += len(step)
    taken += reader.read()
    assert taken == accepted
    assert reader.dropped_bytes == dropped


def test_a_full_ring_drops_whole_chunks_and_goes_on() -> None:
    writer, reader = both_ends(64)
    assert writer.write(b"a" * 40, 1)
    assert not writer.write(b"b" * 40, 2)
    assert (reader.dropped_chunks, reader.dropped_bytes) == (1, 40)
    assert reader.read() == [Chunk(1, b"a" * 40)]
    assert writer.write(b"c" * 40, 3)
    assert reader.read() == [Chunk(3, b"c" * 40)]


def test_the_reader_learns_of_the_end() -> None:
    writer, reader = both_ends(64)
    writer.write(b"last", 5)
    assert not reader.closed
    writer.close()
    assert reader.closed
    assert reader.read() == [Chunk(5, b"last")]


@pytest.mark.parametrize(("capacity", "fits"), [(64, 40), (65, 48), (72, 48), (73, 56)])
def test_a_chunk_fits_that_fills_the_ring(capacity: int, fits: int) -> None:
    """Capacities are rounded up to whole words of eight bytes, and a chunk's head takes three of those."""
    writer, reader = both_ends(capacity)
    assert not writer.write(bytes(fits + 1), 1)
    for stamp in (2, 3, 4):  # also across the end of the memory
        assert writer.write(bytes([stamp]) * fits, stamp)
        assert not writer.write(b"", 9)
        assert reader.read() == [Chunk(stamp, bytes([stamp]) * fits)]
    assert (reader.dropped_chunks, reader.dropped_bytes) == (4, fits + 1)


def test_marks_and_stamps_go_with_their_chunks() -> None:
    writer, reader = both_ends(200)
    sent = [Chunk(-5, b"a"), Chunk(2**62, b"", Mark.OPENED), Chunk(7, b"gone", Mark.LOST)]
    assert all([writer.write(one.data, one.stamp_ns, one.mark) for one in sent])
    assert reader.read() == sent and reader.read() == []
    assert [mark.name for mark in (Mark(0), Mark(1), Mark(2))] == ["DATA", "OPENED", "LOST"]
