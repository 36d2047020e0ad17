"""A ring of stamped byte chunks in shared memory: one process writes, another reads, neither ever waits."""

import ctypes
import struct
from collections.abc import Iterator
from enum import IntEnum
from multiprocessing.context import BaseContext
from typing import NamedTuple

#: Anonymous shared memory: it has no name in /dev/shm, so there is nothing to leave behind after a kill.
Memory = ctypes.Array[ctypes.c_char]

#: Bytes of the integers that the state consists of, and of the state: a cache line.
_WORD = 8
_STATE_BYTES = 64
#: Length of the chunk, its stamp, what it is.
_HEADER = struct.Struct("<3q")
_WRITTEN, _READ, _DROPPED_BYTES, _DROPPED_CHUNKS, _CLOSED = range(5)


class Mark(IntEnum):
    """What a chunk is: bytes of the device, or what became of the port they came from and was written to it."""

    DATA = 0
    #: The port was opened again: what follows is of a device that must say what it is.
    OPENED = 1
    #: The port went away; the bytes are a sentence.
    LOST = 2
    #: The device was sent a command that it answers with an INFO frame, which takes a number of its own.
    ASKED = 3


#: Looked up by their numbers: an enumeration does it more slowly.
_MARKS = tuple(Mark)


class Chunk(NamedTuple):
    """Bytes as they arrived; ``stamp_ns`` is the host's monotonic clock when they did."""

    stamp_ns: int
    data: bytes
    mark: Mark = Mark.DATA


def ring_memory(context: BaseContext, capacity: int) -> Memory:
    """Return shared memory for a ring of ``capacity`` bytes, to be handed to the processes at either end."""
    rounded = -(-capacity // _WORD) * _WORD
    memory: Memory = context.RawArray(ctypes.c_char, _STATE_BYTES + rounded)
    return memory


class Ring:
    """One end of the ring. The writer calls `write` and `close`, the reader `read`.

    The two positions are whole aligned words that only one side writes, and the writer moves its own after
    the bytes are in place. A processor that showed them out of order would hand over a torn chunk, which the
    checksums of the frames in it would tell.
    """

    def __init__(self, memory: Memory) -> None:
        view = memoryview(memory).cast("B")
        self._state = view[:_STATE_BYTES].cast("q")
        self._bytes = view[_STATE_BYTES:]
        self._capacity = len(self._bytes)

    @property
    def dropped_bytes(self) -> int:
        """Bytes that found no room because the reader had fallen a whole ring behind."""
        return self._state[_DROPPED_BYTES]

    @property
    def dropped_chunks(self) -> int:
        """Chunks that found no room."""
        return self._state[_DROPPED_CHUNKS]

    @property
    def closed(self) -> bool:
        """Whether the writer has written its last chunk."""
        return bool(self._state[_CLOSED])

    def write(self, data: bytes | memoryview, stamp_ns: int, mark: Mark = Mark.DATA) -> bool:
        """Put a chunk in; where there is no room for all of it, drop and count it and return False."""
        start = self._state[_WRITTEN]
        size = _HEADER.size + len(data)
        if size > self._capacity - (start - self._state[_READ]):
            self._state[_DROPPED_BYTES] += len(data)
            self._state[_DROPPED_CHUNKS] += 1
            return False
        self._put(start, _HEADER.pack(len(data), stamp_ns, mark))
        self._put(start + _HEADER.size, data)
        self._state[_WRITTEN] = start + size
        return True

    def read(self) -> list[Chunk]:
        """Take out every chunk that is there."""
        return list(self._take(self._state[_WRITTEN]))

    def close(self) -> None:
        """Say that no chunk will follow."""
        self._state[_CLOSED] = 1

    def _take(self, end: int) -> Iterator[Chunk]:
        start = self._state[_READ]
        while start < end:
            length, stamp_ns, mark = _HEADER.unpack(self._get(start, _HEADER.size))
            data = self._get(start + _HEADER.size, length)
            start += _HEADER.size + length
            self._state[_READ] = start
            yield Chunk(stamp_ns, data, _MARKS[mark])

    def _put(self, position: int, data: bytes | memoryview) -> None:
        begin = position % self._capacity
        first = min(len(data), self._capacity - begin)
        self._bytes[begin : begin + first] = data[:first]
        if first < len(data):
            self._bytes[: len(data) - first] = data[first:]

    def _get(self, position: int, length: int) -> bytes:
        begin = position % self._capacity
        first = min(length, self._capacity - begin)
        found = bytes(self._bytes[begin : begin + first])
        return found if first == length else found + bytes(self._bytes[: length - first])
