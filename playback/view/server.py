"""The web server of the page, kept to itself: quiet, and without a public address."""

import asyncio
import contextlib
import socket
import warnings
from collections.abc import Callable, Iterator
from typing import TypeVar

import rich
import viser

from limbcal.errors import DeviceError
from playback.view.visitors import Visitors, checked

T = TypeVar("T")


class QuietServer(viser.ViserServer):
    """viser's server without its button, and its request, for a public address of the page."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: whoever sees the page can move the arm."""
        return None


def on_loop(server: viser.ViserServer, work: Callable[[], T]) -> T:
    """Do what changes the page in the thread that sends to pages, and return what it returns.

    viser's handles wake their senders with ``asyncio.Event.set``, which is for that thread only: from another one
    it fails now and then, with "deque mutated during iteration", as soon as pages are connected.
    """

    async def carried_out() -> T:
        return work()

    return asyncio.run_coroutine_threadsafe(carried_out(), server.get_event_loop()).result()


@contextlib.contextmanager
def web_server(visitors: Visitors, port: int, title: str) -> Iterator[viser.ViserServer]:
    """Serve a page until left.

    Raises
    ------
    DeviceError
        If the port is taken or the host is none of this machine's.
    """
    _require_free(visitors.address, port)
    rich.reconfigure(quiet=True)  # viser tells of itself on stdout, which belongs to the answer
    with checked(visitors):
        server = QuietServer(visitors.address, port, title, verbose=False)
    try:
        yield server
    finally:
        # a picture may be on its way while the page is stopped; that it does not arrive is no news
        warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
        server.stop()


def _require_free(host: str, port: int) -> None:
    """Viser takes the next port where this one is taken, and waits for ever for a host that is not there."""
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        with socket.socket(found[0][0], socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(found[0][4])
    except OSError as error:
        raise DeviceError(f"the page's address {host}:{port} cannot be had: {error.strerror}") from error
