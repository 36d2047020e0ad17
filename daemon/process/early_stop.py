"""A stop that is heard by a child while it is too busy with getting ready to listen."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any

from daemon.process.control_line import ControlLine, SupervisorGone


@contextmanager
def stopped_early(line: ControlLine, close: Callable[[], object]) -> Iterator[None]:
    """End this process where a stop is said within the block, or the supervisor goes.

    A kernel may take a minute to compile, and the compiler cannot be left in the middle of one by an exception
    (`limbcal/uninterrupted.py`). Nothing was received yet that could be lost.

    Parameters
    ----------
    line : ControlLine
        Nobody else listens to it within the block.
    close : callable
        Called before the end, in a thread of its own: gives back what others would find, such as sockets.
    """
    done_read, done_write = os.pipe()
    thread = threading.Thread(target=_listen, args=(line, done_read, close), name="early-stop", daemon=True)
    thread.start()
    try:
        yield
    finally:
        os.write(done_write, b".")
        thread.join()
        os.close(done_read)
        os.close(done_write)


def _listen(line: ControlLine, done: int, close: Callable[[], object]) -> None:
    waited: list[Any] = [line, done]
    while done not in wait(waited):
        try:
            said = line.hear()
        except SupervisorGone:
            break
        if said is not None and said["what"] == "stop":
            break
    else:
        return
    try:
        close()
    finally:
        os._exit(0)
