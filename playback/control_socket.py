"""The ROUTER socket on which playback is told what to do."""

import time
from collections.abc import Callable

import zmq

from limbcal.errors import DeviceError

Answer = Callable[[bytes], bytes]

#: Bytes of a message that the socket still takes in, to refuse it; beyond, ZeroMQ drops the peer.
MESSAGE_LIMIT = 64 * 1024 * 1024
LINGER_MS = 500


class ControlSocket:
    """Takes requests from REQ and DEALER clients and sends each client its reply.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        Where to bind; ``tcp://127.0.0.1:*`` takes any free port.
    answer : callable
        Takes the payload of a request and returns that of its reply; it must not raise.

    Raises
    ------
    DeviceError
        If the endpoint cannot be bound.
    """

    def __init__(self, context: zmq.Context[zmq.Socket[bytes]], endpoint: str, answer: Answer) -> None:
        self._answer = answer
        self._socket = context.socket(zmq.ROUTER)
        self._socket.linger = LINGER_MS
        self._socket.setsockopt(zmq.MAXMSGSIZE, MESSAGE_LIMIT)
        try:
            self._socket.bind(endpoint)
        except zmq.ZMQError as error:
            self._socket.close(linger=0)
            if error.errno == zmq.EADDRINUSE:
                raise DeviceError(f"control endpoint {endpoint} is already taken") from error
            raise DeviceError(f"control endpoint {endpoint} cannot be bound: {error.strerror}") from error
        self.endpoint = self._socket.get_string(zmq.LAST_ENDPOINT)

    def wait(self, seconds: float) -> None:
        """Answer at most one request that comes within so many seconds; return at once when it came.

        ZeroMQ waits whole milliseconds only, so the rest of the time is slept, to be neither early nor late.
        """
        whole_ms = max(0, int(seconds * 1e3))
        until = time.monotonic() + seconds
        if self._socket.poll(whole_ms, zmq.POLLIN):
            self._serve()
        elif (rest := until - time.monotonic()) > 0.0:
            time.sleep(rest)

    def close(self) -> None:
        """Let the last replies go and free the endpoint."""
        self._socket.close()

    def _serve(self) -> None:
        parts = self._socket.recv_multipart()
        # REQ puts an empty part between address and payload, DEALER need not; the reply goes the way back.
        n_envelope = 2 if len(parts) > 2 and not parts[1] else 1
        envelope, body = parts[:n_envelope], parts[n_envelope:]
        self._socket.send_multipart([*envelope, self._answer(body[0] if len(body) == 1 else b"".join(body))])
