"""How long a job takes."""

import time
from collections.abc import Callable

REPEATS = 5


def seconds(
    job: Callable[[], object], repeats: int = REPEATS, clock: Callable[[], float] = time.process_time
) -> float:
    """Return the time of the shortest of some runs [s]: the processor's, unless another clock is given."""
    took = []
    for _ in range(repeats):
        begin = clock()
        job()
        took.append(clock() - begin)
    return min(took)
