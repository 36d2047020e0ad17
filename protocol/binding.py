"""Binding a socket, with what went wrong said in one sentence."""

import errno
import socket as posix
from pathlib import Path

import zmq

from limbcal.errors import ConfigError, DeviceError
from protocol.curve import Gate, needs_keys
from protocol.endpoint import allow_address, is_local


def bind(socket: "zmq.Socket[bytes]", endpoint: str, gate: Gate | None = None) -> str:
    """Bind a socket and return where it really is bound, with the port that a ``*`` became.

    Parameters
    ----------
    socket : zmq.Socket
    endpoint : str
    gate : Gate, optional
        Lets in only whom it knows; without one nobody but this machine may reach the endpoint.

    Raises
    ------
    DeviceError
        If the endpoint is taken or cannot be bound.
    ConfigError
        If the endpoint is not one, or others can reach it and there is no gate.
    """
    if gate is not None:
        gate.guard(socket)
    elif endpoint.partition("://")[0] == "tcp" and not is_local(endpoint):
        raise ConfigError(needs_keys(endpoint))
    if not _port_in_range(endpoint):  # libzmq would take it modulo 65536
        raise ConfigError(f"endpoint is {endpoint!r}, expected a port of at most 65535")
    taken = f"endpoint {endpoint} is already taken, expected a free one"
    if _ipc_in_use(endpoint):
        raise DeviceError(taken)
    allow_address(socket, endpoint)
    try:
        socket.bind(endpoint)
    except zmq.ZMQError as error:
        if error.errno == errno.EADDRINUSE:
            raise DeviceError(taken) from error
        if error.errno in (errno.EINVAL, errno.EPROTONOSUPPORT):
            raise ConfigError(f"endpoint is {endpoint!r}, expected such as tcp://127.0.0.1:5770") from error
        raise DeviceError(f"endpoint {endpoint} cannot be bound: {zmq.strerror(error.errno or 0)}") from error
    return socket.getsockopt_string(zmq.LAST_ENDPOINT)


def _ipc_in_use(endpoint: str) -> bool:
    """Tell whether somebody listens on an ipc endpoint: libzmq would take it over without a word."""
    scheme, _, path = endpoint.partition("://")
    if scheme != "ipc" or not Path(path).is_socket():
        return False
    with posix.socket(posix.AF_UNIX) as probe:
        return probe.connect_ex(path) == 0


def _port_in_range(endpoint: str) -> bool:
    scheme, _, address = endpoint.partition("://")
    port = address.rpartition(":")[2]
    return scheme != "tcp" or not port.isdecimal() or int(port) <= 0xFFFF
