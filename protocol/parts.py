"""Receiving the parts of a message, and no more of them than there may be."""

from dataclasses import dataclass

import zmq

from protocol.message import MAX_PAYLOAD_BYTES
from protocol.peers import PART_OVERHEAD

#: Parts that are kept; ours have 2, and 3 with an envelope. Those beyond are read and forgotten.
MOST_PARTS = 8
#: Bytes of a message: a payload, and beside it the topic and what CURVE adds.
MESSAGE_BYTES = MAX_PAYLOAD_BYTES + 4096


@dataclass(frozen=True)
class Received:
    """The first `MOST_PARTS` parts of a message: one more than were expected is refused by whoever reads them.

    Attributes
    ----------
    parts : list of bytes
    first : zmq.Frame
        The first part as it came, which tells whose it is.
    n_byte : int
        Bytes of all parts, kept or not, with what each takes beside.
    """

    parts: list[bytes]
    first: zmq.Frame
    n_byte: int


def receive_parts(socket: "zmq.Socket[bytes]", most_bytes: int) -> Received:
    """Return the next message, without waiting for one.

    Parameters
    ----------
    socket : zmq.Socket
    most_bytes : int
        Bytes that are kept of all parts; a part that would go beyond is kept as an empty one.

    Raises
    ------
    zmq.Again
        If there is none.
    """
    first = frame = socket.recv(zmq.NOBLOCK, copy=False)
    parts: list[bytes] = []
    kept = n_byte = 0
    while True:
        size = len(frame)
        n_byte += size + PART_OVERHEAD
        if len(parts) < MOST_PARTS:
            fits = kept + size <= most_bytes
            parts.append(frame.bytes if fits else b"")
            kept += size if fits else 0
        if not frame.more:
            return Received(parts, first, n_byte)
        frame = socket.recv(zmq.NOBLOCK, copy=False)
