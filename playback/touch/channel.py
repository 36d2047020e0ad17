"""The ROUTER socket on which devices say where they are, and hear what they feel."""

from collections.abc import Iterator
from dataclasses import dataclass

import zmq

from limbcal.errors import ProtocolError
from playback.touch.message import INPUT_LIMIT, Command, Input, decode_input
from protocol.binding import bind
from protocol.curve import Gate
from protocol.message import encode
from protocol.parts import receive_parts
from protocol.peers import Peers

#: Bytes of a part that the socket takes in, to refuse it; beyond, ZeroMQ drops the peer.
MESSAGE_LIMIT = 2 * INPUT_LIMIT
#: Bytes that a device may have sent and nobody has read, in whatever parts; beyond, it is shown out.
UNREAD_LIMIT = 2 * 1024 * 1024
#: Messages of a device that wait, and bytes that the kernel keeps beside.
_QUEUE, _KERNEL_BYTES = 200, 64 * 1024
#: Messages looked at in one tick: a flood costs a tick no more than this.
AT_ONCE = 64
#: How long closing waits for the last replies to leave [ms].
_LINGER_MS = 100


@dataclass(frozen=True)
class Heard:
    """What a device said, and the parts that its answer begins with; its address is the first."""

    envelope: tuple[bytes, ...]
    said: Input | Command


class HapticChannel:
    """Takes inputs from REQ and DEALER devices; of each device only the newest counts.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        Where to bind; ``tcp://127.0.0.1:*`` takes any free port.
    n_joint : int
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
        self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, n_joint: int, gate: Gate | None = None
    ) -> None:
        self._n_joint = n_joint
        self._socket = context.socket(zmq.ROUTER)
        self._socket.set(zmq.LINGER, _LINGER_MS)
        self._socket.set(zmq.MAXMSGSIZE, MESSAGE_LIMIT)
        self._socket.set(zmq.RCVHWM, _QUEUE)
        self._socket.set(zmq.RCVBUF, _KERNEL_BYTES)
        self._peers = Peers(context, self._socket, UNREAD_LIMIT)
        try:
            self.endpoint = bind(self._socket, endpoint, gate)
        except BaseException:
            self._peers.close()
            self._socket.close(0)
            raise

    def drain(self) -> Iterator[Heard]:
        """Take in what has come: every command, and the newest input of each device.

        What is none is refused. An input that a newer one has overtaken is not answered.
        """
        self._peers.look()  # from here and not from a thread, which could be late in giving way to the loop
        newest: dict[bytes, tuple[tuple[bytes, ...], bytes]] = {}
        for _ in range(AT_ONCE):
            try:
                received = receive_parts(self._socket, MESSAGE_LIMIT)
            except zmq.Again:
                break
            self._peers.handed(received.first, received.n_byte)
            parts = received.parts
            # REQ puts an empty part between address and payload, DEALER need not; the reply goes the way back
            n_envelope = 2 if len(parts) > 2 and not parts[1] else 1
            envelope = tuple(parts[:n_envelope])
            if len(parts) != n_envelope + 1:
                found = len(parts) - n_envelope
                self.answer(envelope, {"error": f"input: {found} parts, expected 1"})
                continue
            if b"\xa3cmd" in parts[-1]:
                yield from self._read(envelope, parts[-1])
            else:
                newest[parts[0]] = envelope, parts[-1]
        for envelope, payload in newest.values():
            yield from self._read(envelope, payload)

    def answer(self, envelope: tuple[bytes, ...], fields: dict[str, object]) -> None:
        """Tell a device; one that does not listen, or is gone, misses it."""
        try:
            self._socket.send_multipart([*envelope, encode("haptic", fields)[1]], zmq.NOBLOCK)
        except zmq.ZMQError:
            return

    def close(self) -> None:
        """Let the last answers go and free the endpoint."""
        self._peers.close()
        self._socket.close()

    def _read(self, envelope: tuple[bytes, ...], payload: bytes) -> Iterator[Heard]:
        try:
            yield Heard(envelope, decode_input(payload, self._n_joint))
        except ProtocolError as error:
            self.answer(envelope, {"error": str(error)})
