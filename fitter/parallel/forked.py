"""Work shared with processes that are forked for it: they know all that this one knows, and answer with little.

A forked process needs nothing sent to it, neither data nor code, and what has been computed before is there. It
runs nothing but the work, in one thread, and leaves without cleaning up what is not its own. A lock that another
thread holds at that instant would be held in it for ever; so a process that has other threads of the interpreter
does all of the work itself.
"""

import os
import pickle
import signal
import struct
import threading
import warnings
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from fitter.parallel.processors import processors, work_alone
from limbcal.parent import end_with

Item = TypeVar("Item")
Result = TypeVar("Result")

_NUMBER = struct.Struct("=H")


def side_by_side(
    work: Callable[[Item], Result],
    items: Sequence[Item],
    progress: Callable[[int, int], None] | None = None,
) -> list[Result]:
    """Return what work makes of every item, in order.

    Parameters
    ----------
    work : callable
        It must not change anything that is needed later: what it does in another process stays there.
    items : sequence
        No more than 30000: their numbers wait in a pipe.
    progress : callable, optional
        Called now and then with how many are begun, and how many there are.

    Raises
    ------
    Exception
        What the work on an item raises.
    """
    most = processors(len(items)) if threading.active_count() == 1 else 1
    reading, writing = os.pipe()
    begun: list[_Helper] = []
    done: dict[int, Result] = {}
    try:
        with os.fdopen(writing, "wb") as numbers:  # whoever is free takes the next number
            numbers.write(b"".join(_NUMBER.pack(k) for k in range(len(items))))
        begun = [_Helper(work, items, reading) for _ in range(most - 1)]
        while (k := _next(reading)) is not None:
            done[k] = work(items[k])
            if progress is not None:
                progress(k + 1, len(items))
        for helper in begun:
            done |= helper.answer()
    finally:
        os.close(reading)
        for helper in begun:
            helper.end()
    missing = (k for k in range(len(items)) if k not in done)  # of a helper that was killed
    done |= {k: work(items[k]) for k in missing}
    return [done[k] for k in range(len(items))]


class _Helper:
    """A forked process that takes numbers from a queue as long as there are any."""

    def __init__(self, work: Callable[[Any], Any], items: Sequence[Any], queue: int) -> None:
        self._answers, writing = os.pipe()
        with warnings.catch_warnings():
            # Python warns of libraries' threads, too; they hold no lock of the interpreter, and C's are made anew.
            warnings.simplefilter("ignore", DeprecationWarning)
            parent = os.getpid()
            self._process = os.fork()
        if self._process == 0:
            _be_helper(work, items, queue, writing, parent)
        os.close(writing)

    def answer(self) -> dict[int, Any]:
        """Return what it has made of its items; nothing if it was killed."""
        with os.fdopen(os.dup(self._answers), "rb") as answers:
            said = answers.read()
        if not said:
            return {}
        found, error = pickle.loads(said)  # noqa: S301 - our own process wrote it
        if error is not None:
            raise error
        return dict(found)

    def end(self) -> None:
        """End it, if it has not ended, and wait until it has."""
        os.close(self._answers)
        os.kill(self._process, signal.SIGKILL)  # it is a zombie at least, so this is its number
        os.waitpid(self._process, 0)


def _be_helper(work: Callable[[Any], Any], items: Sequence[Any], queue: int, writing: int, parent: int) -> None:
    found, error = {}, None
    try:
        end_with(parent)
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # who forked it ends it
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        work_alone()
        while (k := _next(queue)) is not None:
            found[k] = work(items[k])
    except BaseException as raised:  # whatever it is, the parent hears of it
        error = raised
    try:
        with os.fdopen(writing, "wb") as answers:
            pickle.dump((found, error), answers, pickle.HIGHEST_PROTOCOL)
    finally:
        os._exit(0)


def _next(queue: int) -> int | None:
    """Return the next number that nobody has taken, or None."""
    taken = os.read(queue, _NUMBER.size)  # so short a read of a pipe is never divided
    return _NUMBER.unpack(taken)[0] if taken else None
