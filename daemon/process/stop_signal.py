"""SIGINT and SIGTERM as something to wait for, instead of an exception between any two lines."""

import os
import signal
from types import FrameType, TracebackType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class StopSignal:
    """While entered, either signal is noted and makes `fileno` readable; a second one changes nothing.

    Must be entered in the main thread.
    """

    def __init__(self) -> None:
        self._came = False
        self._read_end = self._write_end = -1
        self._before: list[object] = []

    def __enter__(self) -> "StopSignal":
        """Take over the signals."""
        self._read_end, self._write_end = os.pipe()
        self._before = [signal.signal(number, self._note) for number in _SIGNALS]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the signals back."""
        for number, handler in zip(_SIGNALS, self._before, strict=True):
            signal.signal(number, handler)  # type: ignore[arg-type]
        os.close(self._read_end)
        os.close(self._write_end)

    @property
    def came(self) -> bool:
        """Whether a stop was asked for."""
        return self._came

    def fileno(self) -> int:
        """Return a descriptor that is readable once a stop was asked for."""
        return self._read_end

    def _note(self, _number: int, _frame: FrameType | None) -> None:
        if not self._came:
            self._came = True
            os.write(self._write_end, b".")
