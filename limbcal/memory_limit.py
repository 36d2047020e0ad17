"""A bound on the memory that a library may take for one file, however large a number in it is."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_STATUS = Path("/proc/self/statm")  # its first number: pages of address space, proc_pid_statm(5)


@contextmanager
def memory_limit(more_bytes: int) -> Iterator[None]:
    """Let the process take so much more address space within, and no more; beyond it allocations fail at once.

    Where the system does not say how much there is, nothing is bounded.

    Parameters
    ----------
    more_bytes : int
    """
    if not _STATUS.exists():
        yield
        return
    now = int(_STATUS.read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    before, most = resource.getrlimit(resource.RLIMIT_AS)
    wanted = now + more_bytes
    bounds = [one for one in (before, most, wanted) if one != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min(bounds), most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (before, most))
