"""Binding and connecting a socket, with what went wrong said in one sentence."""

import errno
import os
import socket as posix
import stat
from pathlib import Path

import zmq

from limbcal.errors import ConfigError, DeviceError
from protocol.curve import Gate, needs_keys
from protocol.endpoint import Endpoint, parse_endpoint

#: Bits that a socket's file does not get: connecting takes the right to write (unix(7)).
_OWNER_ONLY = 0o177


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
        If the endpoint is not one, others can reach it and there is no gate, or there is a file that is no socket.
    """
    where = parse_endpoint(endpoint)
    if gate is not None:
        gate.guard(socket)
    elif not where.is_local:
        raise ConfigError(needs_keys(endpoint))
    taken = f"endpoint {endpoint} is already taken, expected a free one"
    if where.path is not None and _in_use(where.path, endpoint):
        raise DeviceError(taken)
    _allow_address(socket, where)
    # what a peer sends over a socket in a folder cannot be measured, so nobody but its owner may connect
    before = os.umask(_OWNER_ONLY) if where.path is not None else None
    try:
        socket.bind(where.text)
    except zmq.ZMQError as error:
        if error.errno == errno.EADDRINUSE:
            raise DeviceError(taken) from error
        raise DeviceError(f"endpoint {endpoint} cannot be bound: {zmq.strerror(error.errno or 0)}") from error
    finally:
        if before is not None:
            os.umask(before)
    return socket.getsockopt_string(zmq.LAST_ENDPOINT)


def connect(socket: "zmq.Socket[bytes]", endpoint: str) -> None:
    """Connect a socket; whoever is to be there may come up later.

    Raises
    ------
    ConfigError
        If the endpoint is not one, or names nobody in particular.
    """
    where = parse_endpoint(endpoint)
    if where.text.startswith("tcp://*:") or where.text.endswith((":*", ":0")):
        raise ConfigError(f"endpoint is {endpoint!r}, expected a host and a port to connect to")
    _allow_address(socket, where)
    try:
        socket.connect(where.text)
    except zmq.ZMQError as error:
        raise ConfigError(
            f"endpoint is {endpoint!r}, which cannot be connected to: {zmq.strerror(error.errno or 0)}"
        ) from error


def _allow_address(socket: "zmq.Socket[bytes]", where: Endpoint) -> None:
    """Let a socket have an address of IPv6, if it is one; with others ``*`` and names mean what they meant."""
    if where.is_ipv6:
        socket.set(zmq.IPV6, 1)


def _in_use(path: Path, endpoint: str) -> bool:
    """Tell whether somebody listens there; ZeroMQ would take it over, and delete any file, unasked."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return False
    except OSError as error:
        raise DeviceError(f"endpoint {endpoint} cannot be bound: {error.strerror}") from error
    if not stat.S_ISSOCK(mode):
        raise ConfigError(f"endpoint {endpoint} is a file that is no socket; expected a path that is free")
    with posix.socket(posix.AF_UNIX) as probe:
        return probe.connect_ex(str(path)) == 0
