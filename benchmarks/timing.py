"""Times of the processor."""

import time
from collections.abc import Callable

REPEATS = 5


def seconds(job: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the processor's time for a job: the shortest of some runs."""
    took = []
    for _ in range(repeats):
        begin = time.process_time()
        job()
        took.append(time.process_time() - begin)
    return min(took)
