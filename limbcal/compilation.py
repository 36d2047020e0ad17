"""Saying that kernels are compiled, when they are: so that nobody waits in the dark."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

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

    def document(self) -> dict[str, object]:
        """Return the JSON document of a command that compiles."""
        return {"compiled": self.kernels}

    def close(self) -> None:
        """Take away what is shown."""
        self._status.stop()


_listening: ContextVar[Compilation | None] = ContextVar("listening", default=None)


@contextmanager
def said_when_compiling(who: str) -> Iterator[Compilation]:
    """Say that kernels are being compiled as soon as one is; show how many while a terminal watches.

    The compiler keeps them on disk, and compiles them anew when their source, the compiler or the processor is
    another one: so whoever must be in time goes through them before. Within another one it says nothing again.

    Parameters
    ----------
    who : str
        The program that compiles.
    """
    outer = _listening.get()
    if outer is not None:
        yield outer
        return
    listener = Compilation(f"{who}: compiling kernels, once on this machine; it takes some minutes")
    token = _listening.set(listener)
    try:
        with event.install_listener("numba:compile", listener):
            yield listener
    finally:
        _listening.reset(token)
        listener.close()
