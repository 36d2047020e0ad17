"""How many processors there are for work that is shared."""

import os
from contextvars import ContextVar

#: More processes than this would wait for memory, and then for one another; a convention.
_MOST = 8
#: Whether this process does its work one by one, as one does that was forked for a share of it.
_alone = ContextVar("alone", default=False)


def work_alone() -> None:
    """Do all further work of this process one by one: others have the processors busy."""
    _alone.set(True)


def processors(most: int) -> int:
    """Return how many of ``most`` items may be done at once: one where others have the processors busy."""
    return 1 if _alone.get() else max(1, min(len(os.sched_getaffinity(0)), _MOST, most))
