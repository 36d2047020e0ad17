"""Saying that kernels are compiled, when they are: so that nobody waits in the dark."""

from collections.abc import Iterator
from contextlib import contextmanager

from numba.core import event
from rich.status import Status

from limbcal.command import console, say


class Compilation(event.Listener):
    """Counts kernels while they are compiled; those that the cache on disk has are not.

    Attributes
    ----------
    kernels : int
        Compiled so far, those that others are made of left out.
    """

    def __init__(self, sentence: str) -> None:
        self.kernels = 0
        self._sentence = sentence
        self._depth = 0
        self._status = Status("", console=console)

    def on_start(self, event: object) -> None:
        """Say at the first kernel what is going on."""
        if not self._depth and not self.kernels:
            say(self._sentence)
            self._status.start()
        if not self._depth:
            self._status.update(f"kernel {self.kernels + 1}")
        self._depth += 1

    def on_end(self, event: object) -> None:
        """Count a kernel."""
        self._depth -= 1
        self.kernels += not self._depth

    def close(self) -> None:
        """Take away what is shown."""
        self._status.stop()


@contextmanager
def said_when_compiling(who: str) -> Iterator[Compilation]:
    """Say that kernels are being compiled as soon as one is; show how many while a terminal watches.

    The compiler keeps them on disk, and compiles them anew when their source, the compiler or the processor is
    another one: so whoever must be in time goes through them before.

    Parameters
    ----------
    who : str
        The program that compiles.
    """
    listener = Compilation(
        f"{who}: compiling kernels, which takes a minute or two; they are kept on disk for the next time"
    )
    try:
        with event.install_listener("numba:compile", listener):
            yield listener
    finally:
        listener.close()
