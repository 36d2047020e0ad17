"""What an endpoint's address says: who can reach it, and by which version of IP."""

import ipaddress
from urllib.parse import urlsplit

import zmq


def is_local(endpoint: str) -> bool:
    """Say whether only this machine can reach an endpoint."""
    scheme, _, _ = endpoint.partition("://")
    if scheme in ("ipc", "inproc"):
        return True
    try:
        host = urlsplit(endpoint).hostname or ""
        if host == "localhost":
            return True
        address = ipaddress.ip_address(host)
    except ValueError:
        return False
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return (mapped or address).is_loopback


def allow_address(socket: "zmq.Socket[bytes]", endpoint: str) -> None:
    """Let a socket that is about to be bound or connected have an address of IPv6, if it is one.

    Those stand in brackets: ``tcp://[::1]:5770``. Other sockets stay with IPv4, so that ``*`` and names mean what
    they meant.
    """
    if endpoint.startswith("tcp://["):
        socket.set(zmq.IPV6, 1)
