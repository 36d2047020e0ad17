"""Where a socket is bound or connected: the few forms that are allowed, read once, and who can reach them.

What ZeroMQ takes besides is refused (a source address after a ``;``, ``tipc``, ``ws``, abstract ``ipc``):
nothing is handed to it but what was understood here.
"""

import ipaddress
import re
from dataclasses import dataclass
from pathlib import Path

from limbcal.errors import ConfigError

#: TCP counts ports in 16 bits (RFC 9293).
MOST_PORT = 0xFFFF
#: Bytes of a path that `unix(7)` has room for, the last one a NUL.
MOST_PATH = 107
#: A name of a host or an interface (RFC 1123), and of a zone (`fe80::1%eth0`).
_NAME = re.compile(r"[A-Za-z0-9]([A-Za-z0-9-]{0,61}[A-Za-z0-9])?(\.[A-Za-z0-9]([A-Za-z0-9-]{0,61}[A-Za-z0-9])?)*")
_ZONE = re.compile(r"[A-Za-z0-9._-]{1,15}")
_PORT = re.compile(r"[0-9]{1,5}|\*")
_TCP = re.compile(r"tcp://(\[[^\[\]]*\]|[^:\[\]]*):([^:]*)")
_INPROC = re.compile(r"inproc://[A-Za-z0-9._/-]{1,64}")
_LOOPBACK = "127.0.0.1"

Address = ipaddress.IPv4Address | ipaddress.IPv6Address


@dataclass(frozen=True)
class Host:
    """A host as it was understood: ``*``, an address, or a name."""

    text: str
    address: Address | None

    @property
    def is_local(self) -> bool:
        """Whether only this machine has it; a name may be anybody's."""
        return self.address is not None and is_loopback(self.address)

    @property
    def in_brackets(self) -> str:
        """As it stands before a port: an address of IPv6 is in brackets."""
        return f"[{self.text}]" if self.is_ipv6 else self.text

    @property
    def is_ipv6(self) -> bool:
        """Whether it is an address of IPv6."""
        return isinstance(self.address, ipaddress.IPv6Address)


@dataclass(frozen=True)
class Endpoint:
    """An endpoint as it was understood.

    Attributes
    ----------
    text : str
        What ZeroMQ is given: made of what was understood, not of what was written.
    host : Host or None
        None unless it is ``tcp``.
    path : Path or None
        None unless it is ``ipc``.
    """

    text: str
    host: Host | None = None
    path: Path | None = None

    @property
    def is_local(self) -> bool:
        """Whether only this machine can reach it."""
        return self.host is None or self.host.is_local

    @property
    def is_ipv6(self) -> bool:
        """Whether its socket has to be allowed IPv6; others stay with IPv4."""
        return self.host is not None and self.host.is_ipv6


def is_loopback(address: Address) -> bool:
    """Say whether an address is that of this machine for itself, also where IPv4 is written as IPv6."""
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return (mapped or address).is_loopback


def parse_host(text: str) -> Host | None:
    """Return a host, ``localhost`` as the address that it is; None if it is none.

    Parameters
    ----------
    text : str
        An address, IPv6 without its brackets, a name or ``*``.
    """
    if text == "*":
        return Host(text, None)
    if text == "localhost":  # not asked of anybody: where a file says otherwise, it would let others in
        text = _LOOPBACK
    plain, mark, zone = text.partition("%")
    try:
        address = ipaddress.ip_address(plain)
    except ValueError:
        all_digits = text.replace(".", "").isdigit()  # `127.1`, which some read as an address
        return Host(text, None) if _NAME.fullmatch(text) and len(text) <= 253 and not all_digits else None
    if mark and (address.version == 4 or not _ZONE.fullmatch(zone)):
        return None
    return Host(text, address)


def parse_endpoint(text: str) -> Endpoint:
    """Return an endpoint: ``tcp://HOST:PORT``, ``ipc://PATH``, or ``inproc://NAME`` within a process.

    HOST is an address (IPv6 in brackets), a name, ``localhost`` or ``*``; PORT is a number, or ``*``: any.

    Raises
    ------
    ConfigError
        If it has another form.
    """
    if text.startswith("ipc://"):
        return _ipc(text, text.removeprefix("ipc://"))
    if _INPROC.fullmatch(text):
        return Endpoint(text)
    found = _TCP.fullmatch(text)
    if found is None or not _PORT.fullmatch(found[2]):
        raise ConfigError(f"endpoint is {text!r}, expected such as tcp://127.0.0.1:5770 or ipc:///run/limb")
    if found[2] != "*" and int(found[2]) > MOST_PORT:  # ZeroMQ would take it modulo 65536
        raise ConfigError(f"endpoint is {text!r}, expected a port of at most {MOST_PORT}")
    host = parse_host(found[1].strip("[]"))
    if host is None or host.is_ipv6 != found[1].startswith("["):
        raise ConfigError(
            f"endpoint is {text!r}, expected an address (IPv6 in brackets), a name or localhost before the port"
        )
    return Endpoint(f"tcp://{host.in_brackets}:{found[2]}", host=host)


def _ipc(text: str, path: str) -> Endpoint:
    if not path or path[0] in "@*" or not path.isprintable() or len(path.encode()) > MOST_PATH:
        raise ConfigError(f"endpoint is {text!r}, expected the path of a socket, of at most {MOST_PATH} bytes")
    return Endpoint(text, path=Path(path))
