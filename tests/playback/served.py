"""A control socket that is served from a thread."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from playback.control_socket import ControlSocket


@contextmanager
def served(socket: ControlSocket) -> Iterator[None]:
    """Answer all that comes within the block; close the socket at its end."""
    over = threading.Event()

    def serve() -> None:
        while not over.is_set():
            if socket.socket.poll(10):
                socket.serve()

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        socket.close()
