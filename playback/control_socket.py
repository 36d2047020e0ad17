"""The ROUTER socket on which playback takes commands."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import zmq

from playback.control_message import REQUEST_LIMIT
from protocol.binding import bind
from protocol.curve import Gate
from protocol.parts import receive_parts
from protocol.peers import Peers

Answer = Callable[[Sequence[bytes]], bytes]

#: Bytes of a part that the socket still takes in, to refuse it; beyond, ZeroMQ drops the peer.
MESSAGE_LIMIT = 2 * REQUEST_LIMIT
#: Bytes that a client may have sent and nobody has read, in whatever parts; beyond, it is shown out.
UNREAD_LIMIT = 2 * 1024 * 1024
#: Bytes of replies kept for a client that takes them slowly; beyond, it is not heard until it has taken some.
KEPT_LIMIT = 8 * 1024 * 1024
#: Replies that ZeroMQ holds of each client; what it cannot take is kept here, where bytes are counted.
_QUEUE = 64
#: How long closing waits for the last replies to leave [ms].
LINGER_MS = 250


@dataclass
class _Kept:
    """Replies that a client has yet to take, each behind its envelope, and their bytes."""

    replies: deque[tuple[list[bytes], bytes]] = field(default_factory=deque)
    n_byte: int = 0


class ControlSocket:
    """Takes requests from REQ and DEALER clients and sends each client its reply.

    A reply that its client is too slow for is kept, where ZeroMQ would drop it; nobody else waits for it.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        Where to bind; ``tcp://127.0.0.1:*`` takes any free port.
    answer : callable
        Takes the parts of a request and returns its reply; it must not raise.
    gate : Gate, optional
        Lets in only whom it knows; needed where other machines can reach the endpoint.

    Attributes
    ----------
    unheard : int
        Requests of clients that took no replies; they were neither carried out nor answered.

    Raises
    ------
    DeviceError
        If the endpoint is taken or cannot be bound.
    ConfigError
        If the endpoint is not one.
    """

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, answer: Answer, gate: Gate | None = None
    ) -> None:
        self.unheard = 0
        self._answer = answer
        self._kept: dict[bytes, _Kept] = {}
        self._socket = context.socket(zmq.ROUTER)
        self._socket.set(zmq.LINGER, LINGER_MS)
        self._socket.set(zmq.MAXMSGSIZE, MESSAGE_LIMIT)
        self._socket.set(zmq.SNDHWM, _QUEUE)
        self._socket.set(zmq.RCVHWM, _QUEUE)
        self._socket.set(zmq.RCVBUF, MESSAGE_LIMIT)
        self._socket.set(zmq.ROUTER_MANDATORY, 1)  # a client that cannot take a reply is an error, not passed over
        self._peers = Peers(context, self._socket, UNREAD_LIMIT)
        try:
            self.endpoint = bind(self._socket, endpoint, gate)
        except BaseException:
            self._peers.close()
            self._socket.close(0)
            raise
        self._peers.watch()

    @property
    def socket(self) -> "zmq.Socket[bytes]":
        """The socket, to be waited on."""
        return self._socket

    @property
    def keeps(self) -> bool:
        """Whether replies wait for their clients: `serve` is to be called again soon."""
        return bool(self._kept)

    def serve(self) -> None:
        """Send on what was kept, and answer one request if there is one."""
        for client in list(self._kept):
            self._send_on(client)
        if not self._socket.poll(0, zmq.POLLIN):
            return
        received = receive_parts(self._socket, MESSAGE_LIMIT)
        self._peers.handed(received.first, received.n_byte)
        parts = received.parts
        kept = self._kept.get(parts[0], _Kept())
        if kept.n_byte > KEPT_LIMIT:
            self.unheard += 1
            return
        # REQ puts an empty part between address and payload, DEALER need not; the reply goes the way back.
        n_envelope = 2 if len(parts) > 2 and not parts[1] else 1
        reply = self._answer(parts[n_envelope:])
        kept.replies.append((parts[:n_envelope], reply))
        kept.n_byte += len(reply)
        self._kept[parts[0]] = kept
        self._send_on(parts[0])

    def _send_on(self, client: bytes) -> None:
        """Send a client its replies, as many as it takes."""
        kept = self._kept[client]
        try:
            while kept.replies:
                envelope, reply = kept.replies[0]
                self._socket.send_multipart([*envelope, reply], zmq.NOBLOCK)
                kept.replies.popleft()
                kept.n_byte -= len(reply)
        except zmq.Again:
            return
        except zmq.ZMQError as error:
            if error.errno != zmq.EHOSTUNREACH:
                raise
        del self._kept[client]  # all sent, or the client is gone

    def close(self) -> None:
        """Let the last replies go and free the endpoint."""
        self._peers.close()
        self._socket.close()
