"""The device's end of the haptic channel."""

from types import TracebackType

import zmq

from arm.model import Floats
from limbcal.errors import DeviceError, ProtocolError
from playback.touch.message import decode_reply, encode_input
from protocol.binding import connect
from protocol.curve import ClientKey
from protocol.parts import MESSAGE_BYTES, receive_parts

#: How soon a server that comes up later is found [ms].
_RECONNECT_MS = 20


class TouchDevice:
    """Says where a hand is and hears what it feels; neither ever waits, and only the newest of each counts.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        That of the haptic channel.
    key : ClientKey, optional
        Where the channel lets in only whom it knows.

    Raises
    ------
    ConfigError
        If the endpoint is not one.
    """

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, key: ClientKey | None = None
    ) -> None:
        self._context, self._endpoint, self._key = context, endpoint, key
        self._socket = self._connected(zmq.DEALER, True)
        self.seq = -1

    def send(
        self,
        position: Floats | list[float],
        velocity: Floats | list[float] | None = None,
        joint: int | None = None,
        point: Floats | list[float] | None = None,
        orientation: list[float] | None = None,
    ) -> int:
        """Say where the hand is.

        Parameters
        ----------
        position, velocity : (3,)
            In the base frame [m], [m/s].
        joint : int, optional
            Which link it holds, counted from 1; the last unless given.
        point : (3,), optional
            Where, in the link's joint-axis frame [m]; its far end unless given.
        orientation : (4,), optional
            Unit quaternion w, x, y, z of the hand in the base frame; only its changes since it took hold count.

        Returns
        -------
        int
            The number by which the answer names this input.
        """
        self.seq += 1
        plain = {
            "position": _listed(position),
            "velocity": _listed(velocity),
            "joint": joint,
            "point": _listed(point),
            "orientation": orientation,
            "seq": self.seq,
        }
        try:
            self._socket.send(encode_input(plain), zmq.NOBLOCK)
        except zmq.Again:
            pass  # nobody is there yet
        return self.seq

    def latest(self) -> dict[str, object] | None:
        """Return the newest answer, None where none came since the last one.

        Who feeds a device with it must also let the force go where none comes for 20 ms.

        Raises
        ------
        ProtocolError
            If it breaks the protocol, or is a refusal.
        """
        newest = None
        while self._socket.poll(0):
            newest = receive_parts(self._socket, MESSAGE_BYTES).parts[-1]
        return None if newest is None else _accepted(decode_reply(newest))

    def wait(self, timeout_ms: int) -> dict[str, object] | None:
        """Return the newest answer, waiting for one; None if none comes in time."""
        return self.latest() if self._socket.poll(timeout_ms) else None

    def ask(self, cmd: str, q: Floats | list[float] | None = None, timeout_ms: int = 2000) -> dict[str, object]:
        """Ask for ``state``, ``hold``, ``free`` or ``reset`` and return the state.

        Raises
        ------
        DeviceError
            If nobody answers in time.
        ProtocolError
            If it is refused.
        """
        with self._connected(zmq.REQ, False) as socket:
            socket.send(encode_input({"cmd": cmd, "q": _listed(q)}))
            if not socket.poll(timeout_ms):
                raise DeviceError(f"haptic endpoint {self._endpoint}: no answer within {timeout_ms / 1e3:g} s")
            return _accepted(decode_reply(receive_parts(socket, MESSAGE_BYTES).parts[-1]))

    def close(self) -> None:
        """Let go."""
        self._socket.close(0)

    def __enter__(self) -> "TouchDevice":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _connected(self, kind: int, newest_only: bool) -> "zmq.Socket[bytes]":
        socket = self._context.socket(kind)
        socket.set(zmq.LINGER, 0)
        socket.set(zmq.MAXMSGSIZE, MESSAGE_BYTES)
        socket.set(zmq.RECONNECT_IVL, _RECONNECT_MS)
        if newest_only:
            socket.set(zmq.CONFLATE, 1)
        if self._key is not None:
            self._key.apply(socket)
        try:
            connect(socket, self._endpoint)
        except BaseException:
            socket.close(0)
            raise
        return socket


def _listed(values: Floats | list[float] | None) -> list[float] | None:
    return None if values is None else [float(value) for value in values]


def _accepted(reply: dict[str, object]) -> dict[str, object]:
    if "error" in reply:
        raise ProtocolError(f"the haptic loop refused: {reply['error']}")
    return reply
