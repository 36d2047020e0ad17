"""Work shared with processes that are forked for it: they know all that this one knows, and answer with little.

A forked process needs nothing sent to it, neither data nor code, and what has been computed before is there. It
runs nothing but the work, in one thread, and leaves without cleaning up what is not its own.
"""

import os
import pickle
import select
import signal
import struct
import time
import warnings
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from typing import Any, TypeVar

from limbcal.parent import end_with

Item = TypeVar("Item")
Result = TypeVar("Result")

#: More processes than this would wait for memory, and then for one another.
_MOST = 8
_NUMBER = struct.Struct("=H")
#: Whether this process does its work one by one, as one does that was forked here.
_alone = ContextVar("alone", default=False)


def work_alone() -> None:
    """Do all further work of this process one by one: others have the processors busy."""
    _alone.set(True)


def processors(most: int) -> int:
    """Return how many of ``most`` items may be done at once: one where others have the processors busy."""
    return 1 if _alone.get() else max(1, min(len(os.sched_getaffinity(0)), _MOST, most))


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
        Told now and then how many are begun, and how many there are.

    Raises
    ------
    Exception
        What the work on an item raises.
    """
    most, start_s = processors(len(items)), time.monotonic()
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
        patience_s = LEAST_PATIENCE_S + PATIENCE * (time.monotonic() - start_s)
        for helper in begun:
            done |= helper.answer(patience_s)
    finally:
        os.close(reading)
        for helper in begun:
            helper.end()
    missing = (k for k in range(len(items)) if k not in done)  # of a helper that was killed, or hangs
    done |= {k: work(items[k]) for k in missing}
    return [done[k] for k in range(len(items))]


#: A forked process may hang on a lock that another thread held. It is given up after this multiple of the time
#: that the items have taken so far plus a constant [s], both conventions; its items are then done here.
PATIENCE, LEAST_PATIENCE_S = 10.0, 10.0


class _Helper:
    """A forked process that takes numbers from a queue as long as there are any."""

    def __init__(self, work: Callable[[Any], Any], items: Sequence[Any], queue: int) -> None:
        self._answers, writing = os.pipe()
        with warnings.catch_warnings():
            # Other threads may hold locks, so a fork may hang that takes one; this one takes none but its own.
            warnings.simplefilter("ignore", DeprecationWarning)
            parent = os.getpid()
            self._process = os.fork()
        if self._process == 0:
            _be_helper(work, items, queue, writing, parent)
        os.close(writing)

    def answer(self, patience_s: float) -> dict[int, Any]:
        """Return what it has made of its items; nothing if it was killed, or does not answer for so long."""
        if not select.select([self._answers], [], [], patience_s)[0]:
            return {}
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
    except BaseException as raised:  # whatever it is, it is told
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
