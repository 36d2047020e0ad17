"""A signal that comes while the compiler works is acted upon as soon as a kernel is done.

The compiler hands its machine code over in a callback, and an exception there is lost. So is a KeyboardInterrupt,
and with it the code, which the compiler then misses: a Ctrl-C would end a command with an error of the compiler's.
"""

import signal
import threading
from collections.abc import Callable
from types import FrameType

from numba.core import event

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class SignalsLater(event.Listener):
    """Puts off SIGINT and SIGTERM from the first beginning that it hears of until the last end."""

    def __init__(self) -> None:
        self._depth = 0
        self._handlers: dict[signal.Signals, Callable[[int, FrameType | None], object]] = {}
        self._came: list[int] = []

    def on_start(self, _event: object) -> None:
        """Note signals from now on; where Python does nothing about them, or in other threads, it need not."""
        if threading.current_thread() is not threading.main_thread():
            return
        self._depth += 1
        if self._depth == 1:
            for number in _SIGNALS:
                handler = signal.getsignal(number)
                if callable(handler):
                    self._handlers[number] = handler
                    signal.signal(number, self._note)

    def on_end(self, _event: object) -> None:
        """Act upon those that came."""
        if threading.current_thread() is not threading.main_thread():
            return
        self._depth -= 1
        if self._depth:
            return
        while self._handlers:
            signal.signal(*self._handlers.popitem())
        while self._came:
            signal.raise_signal(self._came.pop(0))

    def _note(self, number: int, _frame: FrameType | None) -> None:
        if number not in self._came:
            self._came.append(number)
