"""The sending end: a socket for subscribers that numbers its messages."""

import time
from collections.abc import Mapping
from types import TracebackType
from typing import Any

import zmq

from protocol.binding import bind
from protocol.curve import Gate
from protocol.message import encode
from protocol.peers import LOOK_S
from protocol.subscriptions import Subscriptions

#: Messages kept for a subscriber that is slow; beyond that it loses its own and nobody else's.
SEND_QUEUE = 1000
#: How long closing waits for what was sent last to leave [ms].
LINGER_MS = 250


class Publisher:
    """Publishes messages, each with ``v``, ``arm``, ``run`` and a sequence number per topic.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        Where to bind, such as ``tcp://127.0.0.1:5770``; ``tcp://127.0.0.1:*`` takes any free port.
    arm_name : str
    run : str
        UUID of this process.
    gate : Gate, optional
        Lets in only whom it knows; needed where other machines can reach the endpoint.
    watched : bool
        Whether subscribers are looked at from a thread of its own; otherwise a hundred times a second when
        something is published, and by `attend`, which is to be called as often while nothing is.

    Attributes
    ----------
    last_seq : dict of str to int
        Sequence number of the last message sent, by topic; the first is 0.

    Raises
    ------
    DeviceError
        If the endpoint is taken or cannot be bound.
    ConfigError
        If the endpoint is not one.
    """

    def __init__(
        self,
        context: "zmq.Context[zmq.Socket[bytes]]",
        endpoint: str,
        arm_name: str,
        run: str,
        gate: Gate | None = None,
        watched: bool = False,
    ) -> None:
        self.last_seq: dict[str, int] = {}
        self._arm = arm_name
        self._run = run
        self._attend_s = 0.0
        self._socket = context.socket(zmq.XPUB)
        self._socket.set(zmq.SNDHWM, SEND_QUEUE)
        self._socket.set(zmq.LINGER, LINGER_MS)
        self._subscriptions = Subscriptions(context, self._socket)
        try:
            self._endpoint = bind(self._socket, endpoint, gate)
        except BaseException:
            self._subscriptions.peers.close()
            self._socket.close(0)
            raise
        if watched:
            self._subscriptions.peers.watch()

    @property
    def endpoint(self) -> str:
        """Where it is really bound, with the port that a ``*`` became."""
        return self._endpoint

    def publish(self, topic: str, fields: Mapping[str, Any]) -> list[bytes]:
        """Send a message; never waits.

        Returns
        -------
        list of bytes
            The two parts as sent, so that a recorder can write the very same bytes.

        Raises
        ------
        ProtocolError
            If a field cannot be sent; then nothing is sent and no number is used up.
        """
        seq = self.last_seq.get(topic, -1) + 1
        parts = encode(topic, {**fields, "arm": self._arm, "run": self._run, "seq": seq})
        self._socket.send(parts[0], zmq.SNDMORE)
        self._socket.send(parts[1])
        self.last_seq[topic] = seq
        if time.monotonic() >= self._attend_s:  # a look costs as much as to send, and a block is several messages
            self.attend()
        return parts

    @property
    def refused(self) -> int:
        """Subscribers that were shown out: they asked for too much."""
        return self._subscriptions.peers.refused

    def attend(self) -> None:
        """Take in what subscribers ask for, and show out who asks for too much."""
        self._subscriptions.look()
        self._attend_s = time.monotonic() + LOOK_S

    @property
    def socket(self) -> "zmq.Socket[bytes]":
        """The socket, which can be read when somebody subscribes."""
        return self._socket

    def joined(self) -> bool:
        """Say whether anybody subscribed to something since the last time."""
        self.attend()
        return self._subscriptions.joined()

    def close(self) -> None:
        """Close the socket; harmless when repeated."""
        self._subscriptions.peers.close()
        self._socket.close()

    def __enter__(self) -> "Publisher":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
