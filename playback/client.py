"""The asking end of the control socket."""

import zmq

from limbcal.errors import DeviceError
from playback.control_message import Request, decode_reply, encode_request
from protocol.binding import connect
from protocol.parts import MESSAGE_BYTES, receive_parts


def ask(
    context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, request: Request, timeout_ms: int
) -> dict[str, object]:
    """Send one request and return the reply.

    Raises
    ------
    DeviceError
        If nobody answers in time.
    ConfigError
        If the endpoint is not one.
    ProtocolError
        If the reply breaks the protocol.
    """
    with context.socket(zmq.REQ) as socket:
        socket.set(zmq.LINGER, 0)
        socket.set(zmq.MAXMSGSIZE, MESSAGE_BYTES)
        connect(socket, endpoint)
        socket.send(encode_request(request))
        if not socket.poll(timeout_ms):
            raise DeviceError(f"control endpoint {endpoint}: no answer within {timeout_ms / 1e3:g} s")
        return decode_reply(receive_parts(socket, MESSAGE_BYTES).parts[-1])
