"""The receiving end: a SUB socket that knows what it missed."""

from collections.abc import Iterable
from types import TracebackType
from typing import Any

import zmq

from protocol.binding import connect
from protocol.curve import ClientKey
from protocol.message import HEALTH, decode
from protocol.parts import MESSAGE_BYTES, receive_parts
from protocol.peers import Peers

#: Messages kept while the reader is busy; what comes after is lost, and counted.
RECEIVE_QUEUE = 10_000
#: Bytes that a publisher may have sent and nobody has read: two of the largest messages, or 20 s of twelve
#: channels at 32 kHz. A message that does not end is never read.
UNREAD_LIMIT = 32 << 20
#: How soon a publisher that comes up later is found [ms].
RECONNECT_MS = 20


class Subscriber:
    """Receives messages of some topics and counts those that never came.

    A message lost in between shows as a jump of its topic's sequence number. Messages lost at the end of a
    stall leave no jump, so ``last_seq`` of the heartbeat `HEALTH` is used too, where that is subscribed to. A
    publisher that starts anew (another ``run``) is not a loss.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        Where to connect; the publisher may come up later.
    topics : iterable of str
        Topics or beginnings of topics; ``""`` is all.
    key : ClientKey, optional
        Where the publisher lets in only whom it knows.
    watched : bool
        Whether a thread of its own looks at how much the publisher has sent that nobody has read; otherwise it is
        looked at whenever something is received.

    Attributes
    ----------
    missed : dict of str to int
        Messages lost, by topic.
    restarts : int
        How often the publisher turned out to be another run.
    run : str or None
        The publisher's run, once heard of.

    Raises
    ------
    ConfigError
        If the endpoint is not one.
    """

    def __init__(
        self,
        context: "zmq.Context[zmq.Socket[bytes]]",
        endpoint: str,
        topics: Iterable[str],
        key: ClientKey | None = None,
        watched: bool = False,
    ) -> None:
        self.missed: dict[str, int] = {}
        self.restarts = 0
        self.run: str | None = None
        self._last_seq: dict[str, int] = {}
        self._socket = context.socket(zmq.SUB)
        self._socket.set(zmq.LINGER, 0)
        self._socket.set(zmq.RCVHWM, RECEIVE_QUEUE)
        self._socket.set(zmq.RECONNECT_IVL, RECONNECT_MS)
        self._socket.set(zmq.MAXMSGSIZE, MESSAGE_BYTES)
        if key is not None:
            key.apply(self._socket)
        for topic in topics:
            self._socket.setsockopt_string(zmq.SUBSCRIBE, topic)
        self._peers = Peers(context, self._socket, UNREAD_LIMIT)
        try:
            connect(self._socket, endpoint)
        except BaseException:
            self.close()
            raise
        if watched:
            self._peers.watch()

    @property
    def socket(self) -> "zmq.Socket[bytes]":
        """The socket, to be waited on together with others."""
        return self._socket

    def receive(self, timeout_ms: int) -> tuple[str, dict[str, Any]] | None:
        """Return topic and fields of the next message, or None if none came in time.

        Raises
        ------
        ProtocolError
            If the message is not one, or of another version; it is used up, and the next can be received.
        """
        self._peers.look()
        if not self._socket.poll(timeout_ms):
            return None
        topic, fields = decode(self.take())
        self._account(topic, fields)
        return topic, fields

    def take(self) -> list[bytes]:
        """Return the parts of the next message as they came, without waiting for one; they count for nothing.

        Raises
        ------
        zmq.Again
            If there is none.
        """
        received = receive_parts(self._socket, MESSAGE_BYTES)
        self._peers.handed(received.first, received.n_byte)
        return received.parts

    @property
    def refused(self) -> int:
        """How often a publisher was left that sent more than can be read; it is connected to anew."""
        return self._peers.refused

    def close(self) -> None:
        """Close the socket; harmless when repeated."""
        self._peers.close()
        self._socket.close()

    def __enter__(self) -> "Subscriber":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _account(self, topic: str, fields: dict[str, Any]) -> None:
        run, seq = fields.get("run"), fields.get("seq")
        if isinstance(run, str) and run != self.run:
            self.restarts += self.run is not None
            self.run = run
            self._last_seq.clear()
        if isinstance(seq, int):
            self._reached(topic, seq - 1)  # all before this one must have come
            self._last_seq[topic] = seq
        published = fields.get("last_seq")
        if topic == HEALTH and isinstance(published, dict):
            for other, last in published.items():
                if isinstance(last, int):
                    self._reached(other, last)

    def _reached(self, topic: str, seq: int) -> None:
        """Count what is missing up to a number; the first message of a topic is where counting begins."""
        before = self._last_seq.get(topic)
        if before is not None and seq > before:
            self.missed[topic] = self.missed.get(topic, 0) + seq - before
            self._last_seq[topic] = seq
