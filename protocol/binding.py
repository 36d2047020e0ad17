"""Binding a socket, with what went wrong said in one sentence."""

import errno
import socket as posix
from pathlib import Path

import zmq

from limbcal.errors import ConfigError, DeviceError


def bind(socket: "zmq.Socket[bytes]", endpoint: str) -> str:
    """Bind a socket and return where it really is bound, with the port that a ``*`` became.

    Raises
    ------
    DeviceError
        If the endpoint is taken or cannot be bound.
    ConfigError
        If the endpoint is not one.
    """
    taken = f"endpoint {endpoint} is already taken, expected a free one"
    if _ipc_in_use(endpoint):
        raise DeviceError(taken)
    try:
        socket.bind(endpoint)
    except zmq.ZMQError as error:
        if error.errno == errno.EADDRINUSE:
            raise DeviceError(taken) from error
        if error.errno in (errno.EINVAL, errno.EPROTONOSUPPORT):
            expected = "expected such as tcp://127.0.0.1:5770"
            raise ConfigError(f"endpoint {endpoint!r} is not one, {expected}") from error
        raise DeviceError(f"endpoint {endpoint} cannot be bound: {zmq.strerror(error.errno or 0)}") from error
    return socket.getsockopt_string(zmq.LAST_ENDPOINT)


def _ipc_in_use(endpoint: str) -> bool:
    """Tell whether somebody listens on an ipc endpoint: libzmq would take it over without a word."""
    scheme, _, path = endpoint.partition("://")
    if scheme != "ipc" or not Path(path).is_socket():
        return False
    with posix.socket(posix.AF_UNIX) as probe:
        return probe.connect_ex(path) == 0
