"""Who may see the page, and move the arm with it: its own origin, and on other machines whoever has its token.

A browser lets the pages that it shows send to any address, this machine's own too. What it lets no page forge are
a request's Host and Origin: a page from elsewhere has another Origin, and one whose name was made to lead here
(DNS rebinding) has a Host that is no name of this machine.
"""

import contextlib
import hmac
import http
import secrets
from collections.abc import Awaitable, Callable, Iterator
from typing import Any
from urllib.parse import parse_qs, urlsplit

import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import MultipleValuesError
from websockets.http11 import Request, Response

from limbcal.errors import ConfigError, DeviceError
from protocol.endpoint import Host, parse_host

#: Bytes of a message from a page: where a handle is dragged to, a number that was typed.
MESSAGE_LIMIT = 1 << 20
#: Of a token: 128 bits are not guessed.
_TOKEN_BYTES = 16
_PARAMETER = "token"
#: Nobody else's page may have this one inside it, where a click could be led astray.
_NOT_INSIDE = {"X-Frame-Options": "DENY", "Content-Security-Policy": "frame-ancestors 'none'"}


class Visitors:
    """What a request must have to be let in.

    Parameters
    ----------
    host : str
        Where the page is served.

    Attributes
    ----------
    token : str or None
        None where only this machine can reach the page.

    Raises
    ------
    ConfigError
        If the host is none.
    """

    def __init__(self, host: str) -> None:
        self._host = parse_host(_bare(host))
        if self._host is None or self._host.text == "*":
            raise ConfigError(f"--host is {host!r}, expected an address or a name of this machine")
        self.token = None if self._host.is_local else secrets.token_urlsafe(_TOKEN_BYTES)

    @property
    def address(self) -> str:
        """Where the page is to be served."""
        assert self._host is not None
        return self._host.text

    def url(self, port: int) -> str:
        """Return where the page is opened, with what it takes to be let in."""
        assert self._host is not None
        query = "" if self.token is None else f"/?{_PARAMETER}={self.token}"
        return f"http://{self._host.in_brackets}:{port}{query}"

    def refusal(self, request: Request, port: int) -> str | None:
        """Return why a request is refused, in a sentence; None where it is let in."""
        try:
            host, origin = request.headers.get("Host"), request.headers.get("Origin")
            cookies = request.headers.get("Cookie", "")
        except MultipleValuesError as error:
            return f"{error} is there twice"
        if host is None or not self._is_ours(host):
            return f"Host is {host!r}, expected a name or an address of this machine"
        if origin is not None and origin != f"http://{host}":
            return f"Origin is {origin!r}, expected the page's own, http://{host}"
        if self.token is not None and not self._knows(self.token, request.path, cookies, port):
            return "the token is missing or wrong; expected the whole address that was printed at the start"
        return None

    def welcome(self, response: Response, request: Request, port: int) -> Response:
        """Return a response with what a browser is to keep to: the token for what the page asks for later."""
        for name, value in _NOT_INSIDE.items():
            response.headers[name] = value
        response.headers["Referrer-Policy"] = "no-referrer"
        if self.token is not None and _PARAMETER in parse_qs(urlsplit(request.path).query):
            cookie = f"{_cookie(port)}={self.token}; Path=/; HttpOnly; SameSite=Strict"
            response.headers["Set-Cookie"] = cookie
        return response

    def _is_ours(self, host: str) -> bool:
        """Say whether nobody else can have made a Host header's name lead here; its port may be a tunnel's.

        Where there is a token, the name is not what keeps others out: no other page knows it.
        """
        found = _host_of(host)
        if found is None:
            return False
        return self.token is not None or found.is_local

    def _knows(self, token: str, path: str, cookies: str, port: int) -> bool:
        offered = parse_qs(urlsplit(path).query).get(_PARAMETER, [])
        for cookie in cookies.split(";"):
            name, _, value = cookie.strip().partition("=")
            if name == _cookie(port):
                offered.append(value)
        return any(hmac.compare_digest(one.encode(), token.encode()) for one in offered)


@contextlib.contextmanager
def checked(visitors: Visitors) -> Iterator[None]:
    """Have a server of websockets' that is started meanwhile ask ``visitors`` before it answers anybody.

    viser has no place for that of its own.

    Raises
    ------
    DeviceError
        If none was started: then nobody would be asked.
    """
    real, started = websockets.asyncio.server.serve, []

    def serve(handler: Any, *place: Any, process_request: Any = None, **options: Any) -> Any:
        started.append(True)
        asked = _asking(visitors, process_request)
        return real(handler, *place, process_request=asked, **{**options, "max_size": MESSAGE_LIMIT})

    websockets.asyncio.server.serve = serve  # type: ignore[assignment,misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = real  # type: ignore[misc]
    if not started:
        raise DeviceError("this version of viser serves its page in another way; expected one that limbcal knows")


def _asking(visitors: Visitors, answer: Any) -> Callable[[ServerConnection, Request], Awaitable[Response | None]]:
    async def asked(connection: ServerConnection, request: Request) -> Response | None:
        port = connection.local_address[1]
        why = visitors.refusal(request, port)
        if why is not None:
            return connection.respond(http.HTTPStatus.FORBIDDEN, f"limbplay view: {why}\n")
        response = answer(connection, request)
        return None if response is None else visitors.welcome(response, request, port)

    return asked


def _cookie(port: int) -> str:
    return f"limbplay-{port}"  # all ports of a host share their cookies


def _bare(host: str) -> str:
    """Return a host without the brackets that an address of IPv6 may be in."""
    return host[1:-1] if host.startswith("[") and host.endswith("]") else host


def _host_of(header: str) -> Host | None:
    """Return the host of a Host header, None where it is none."""
    name, mark, port = header.rpartition(":")
    if not mark or header.endswith("]"):
        name, port = header, "80"
    if not (port.isascii() and port.isdigit()):
        return None
    bare = _bare(name)
    host = parse_host(bare)
    return None if host is None or host.text == "*" or host.is_ipv6 != (bare != name) else host
