"""The ROUTER socket on which playback is told what to do."""

from collections.abc import Callable, Sequence

import zmq

from protocol.binding import bind
from protocol.curve import Gate

Answer = Callable[[Sequence[bytes]], bytes]

#: Bytes of a message that the socket still takes in, to refuse it; beyond, ZeroMQ drops the peer.
MESSAGE_LIMIT = 64 * 1024 * 1024
#: How long closing waits for the last replies to leave [ms].
LINGER_MS = 250


class ControlSocket:
    """Takes requests from REQ and DEALER clients and sends each client its reply.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        Where to bind; ``tcp://127.0.0.1:*`` takes any free port.
    answer : callable
        Takes the parts of a request and returns its reply; it must not raise.
    gate : Gate, optional
        Lets in only whom it knows; needed where other machines can reach the endpoint.

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
        self._answer = answer
        self._socket = context.socket(zmq.ROUTER)
        self._socket.set(zmq.LINGER, LINGER_MS)
        self._socket.set(zmq.MAXMSGSIZE, MESSAGE_LIMIT)
        try:
            self.endpoint = bind(self._socket, endpoint, gate)
        except BaseException:
            self._socket.close(0)
            raise

    @property
    def socket(self) -> "zmq.Socket[bytes]":
        """The socket, to be waited on."""
        return self._socket

    def serve(self) -> None:
        """Answer one request if there is one."""
        if not self._socket.poll(0, zmq.POLLIN):
            return
        parts = self._socket.recv_multipart()
        # REQ puts an empty part between address and payload, DEALER need not; the reply goes the way back.
        n_envelope = 2 if len(parts) > 2 and not parts[1] else 1
        reply = self._answer(parts[n_envelope:])
        self._socket.send_multipart([*parts[:n_envelope], reply])

    def close(self) -> None:
        """Let the last replies go and free the endpoint."""
        self._socket.close()
