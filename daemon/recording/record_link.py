"""From the pipeline to the recorder: every message byte for byte, and never waiting for the disk.

Messages gather for a quarter of a second and leave as one, so that neither end is busy with each of them.
"""

import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import msgpack
import zmq

from protocol.binding import bind, connect

Context = zmq.Context[zmq.Socket[bytes]]

#: How long messages are gathered before they are sent together [s].
_GATHER_S = 0.25
#: Sendings that wait, a minute of them. A disk that stalls for longer costs messages, which are counted.
_QUEUE = 240
#: How long closing waits for what the recorder has not taken yet [ms].
_LINGER_MS = 10_000
#: What a sending has room for at first [bytes]: a quarter of a second at 32 kHz, and as much again.
_ROOM_BYTES = 1024 * 1024
#: No packed list begins like these.
_HELLO, _END = b"hello", b"end"


#: A message's topic and payload, or what returns them.
Message = Sequence[bytes] | Callable[[], Sequence[bytes]]


class Entry(NamedTuple):
    """A message to be recorded; ``payload`` is its second part, ``t_ns`` UTC [ns]."""

    topic: str
    payload: bytes
    t_ns: int


class RecordLink:
    """The pipeline's end.

    Attributes
    ----------
    recording : str or None
        Path of the recording; None while nothing can be recorded.
    lost : int
        Messages that the recorder did not get.
    removed : int
        Files of the recording that somebody took away while they were written.
    """

    def __init__(self, context: Context, endpoint: str, recording: str) -> None:
        self.recording: str | None = recording
        self.lost = self.removed = 0
        self._gathered: list[tuple[Message, int]] = []
        self._due_s = 0.0
        self._packer = _packer()
        self._socket = context.socket(zmq.PAIR)
        self._socket.set(zmq.SNDHWM, _QUEUE)
        self._socket.set(zmq.LINGER, _LINGER_MS)
        connect(self._socket, endpoint)
        self._send(_HELLO)

    def write(self, message: Message, t_ns: int) -> None:
        """Hand over a message, topic and payload or what returns them once they are sent, and its time."""
        self._gathered.append((message, t_ns))

    def poll(self) -> None:
        """Send what has gathered, if it is time."""
        if time.monotonic() >= self._due_s:
            self.flush()

    def flush(self) -> None:
        """Send what has gathered."""
        self._due_s = time.monotonic() + _GATHER_S
        if self._gathered:
            gathered, self._gathered = self._gathered, []
            self._packer.pack([(*(one() if callable(one) else one), t_ns) for one, t_ns in gathered])
            with self._packer.getbuffer() as packed:
                size = len(packed)
                if not self._send(packed):
                    self.lost += len(gathered)
            self._packer.reset()
            if size > _ROOM_BYTES:  # after a burst its memory is given back
                self._packer = _packer()

    def check(self) -> None:
        """Hear what the recorder writes to now, if to anything."""
        while self._socket.poll(0):
            self.recording, self.removed = msgpack.unpackb(self._socket.recv())

    def close(self) -> None:
        """Say that this was all, and close; what was handed over still leaves."""
        self.flush()
        self._send(_END)
        self._socket.close()

    def _send(self, message: bytes | memoryview) -> bool:
        try:
            self._socket.send(message, zmq.NOBLOCK)
        except zmq.Again:
            return False
        return True


def _packer() -> msgpack.Packer:
    """Return what is kept: so large a buffer made anew would be mapped, page by page, and given back each time."""
    return msgpack.Packer(autoreset=False, buf_size=_ROOM_BYTES)


class RecordInlet:
    """The recorder's end.

    Attributes
    ----------
    linked, ended : bool
        Whether the pipeline is there, and whether it said that this was all.
    """

    def __init__(self, context: Context, endpoint: str) -> None:
        self.linked = False
        self.ended = False
        self._untold: bytes | None = None
        self._socket = context.socket(zmq.PAIR)
        self._socket.set(zmq.LINGER, 0)
        bind(self._socket, endpoint)

    def receive(self, timeout_s: float) -> list[Entry]:
        """Return the next messages; none where none came within the time."""
        if not self._socket.poll(round(1000 * timeout_s)):
            return []
        message = self._socket.recv()
        self.linked = True
        self._tell()
        if message in (_HELLO, _END):
            self.ended = message == _END
            return []
        return [Entry(topic.decode(), payload, t_ns) for topic, payload, t_ns in msgpack.unpackb(message)]

    def tell(self, recording: str | None, removed: int = 0) -> None:
        """Tell the pipeline what is recorded to now, if to anything; one that is not there yet hears it later.

        ``removed`` is how many files were taken away so far.
        """
        self._untold = msgpack.packb((recording, removed))
        self._tell()

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def _tell(self) -> None:
        if self._untold is None:
            return
        try:
            self._socket.send(self._untold, zmq.NOBLOCK)
        except zmq.Again:
            return
        self._untold = None
