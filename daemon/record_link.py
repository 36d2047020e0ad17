"""From the pipeline to the recorder: every message byte for byte, and never waiting for the disk."""

from collections.abc import Sequence
from typing import NamedTuple

import zmq

Context = zmq.Context[zmq.Socket[bytes]]

#: A minute of all topics. A disk that stalls for longer costs messages, which are counted, not the stream.
_QUEUE = 30_000
_LINGER_MS = 10_000
_HELLO, _END = b"hello", b"end"


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
    """

    def __init__(self, context: Context, endpoint: str, recording: str) -> None:
        self.recording: str | None = recording
        self.lost = 0
        self._socket = context.socket(zmq.PAIR)
        self._socket.set(zmq.SNDHWM, _QUEUE)
        self._socket.set(zmq.LINGER, _LINGER_MS)
        self._socket.connect(endpoint)
        self._send([_HELLO])

    def write(self, parts: Sequence[bytes], t_ns: int) -> None:
        """Hand over a message, topic and payload, and its time."""
        self._send([*parts, t_ns.to_bytes(8, "little", signed=True)])

    def check(self) -> None:
        """Hear what the recorder writes to now, if to anything."""
        while self._socket.poll(0):
            self.recording = self._socket.recv().decode() or None

    def close(self) -> None:
        """Say that this was all, and close; what was handed over still leaves."""
        self._send([_END])
        self._socket.close()

    def _send(self, parts: list[bytes]) -> None:
        try:
            self._socket.send_multipart(parts, zmq.NOBLOCK)
        except zmq.Again:
            self.lost += 1


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
        self._socket = context.socket(zmq.PAIR)
        self._socket.set(zmq.LINGER, 0)
        self._socket.bind(endpoint)

    def receive(self, timeout_s: float) -> Entry | None:
        """Return the next message, or None where none came within the time."""
        if not self._socket.poll(round(1000 * timeout_s)):
            return None
        parts = self._socket.recv_multipart()
        self.linked = True
        if parts in ([_HELLO], [_END]):
            self.ended = parts == [_END]
            return None
        topic, payload, t_ns = parts
        return Entry(topic.decode(), payload, int.from_bytes(t_ns, "little", signed=True))

    def tell(self, recording: str | None) -> None:
        """Tell the pipeline what is recorded to now, if to anything."""
        self._socket.send((recording or "").encode(), zmq.NOBLOCK)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
