"""The asking end of the control socket."""

import zmq

from limbcal.errors import DeviceError
from playback.control_message import Request, decode_reply, encode_request
from protocol.binding import connect
from protocol.curve import ClientKey
from protocol.parts import MESSAGE_BYTES, receive_parts


def ask(
    context: "zmq.Context[zmq.Socket[bytes]]",
    endpoint: str,
    request: Request,
    timeout_ms: int,
    key: ClientKey | None = None,
) -> dict[str, object]:
    """Send one request and return the reply.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
    request : Request
    timeout_ms : int
    key : ClientKey, optional
        Where playback lets in only whom it knows; it answers nobody else.

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
        if key is not None:
            key.apply(socket)
        connect(socket, endpoint)
        socket.send(encode_request(request))
        if not socket.poll(timeout_ms):
            expected = "a `limbplay serve` there that knows this key"
            if key is None:
                expected = "a `limbplay serve` there, and --key where it asks for one"
            raise DeviceError(
                f"control endpoint {endpoint}: no answer within {timeout_ms / 1e3:g} s, expected {expected}"
            )
        return decode_reply(receive_parts(socket, MESSAGE_BYTES).parts[-1])
