"""Memory that a process no longer uses, given back to the system: glibc would keep it after a burst."""

import ctypes
from collections.abc import Callable

_MMAP_THRESHOLD = -3  # M_MMAP_THRESHOLD of mallopt(3)
_TRIM_THRESHOLD = -1  # M_TRIM_THRESHOLD
#: Blocks up to this are kept, the most that glibc allows; and what may lie free at the heap's end: any amount.
_KEPT_BYTES, _ANY_BYTES = 32 * 1024 * 1024, 2**31 - 1


def large_blocks_kept() -> None:
    """Keep what is freed for the next block as large until `give_back`, for as long as the process runs.

    A process that handles as many large blocks every tenth of a second would have each of them mapped page by page
    otherwise, which takes it longer than to write what is in them.
    """
    _glibc("mallopt", _MMAP_THRESHOLD, _KEPT_BYTES)
    _glibc("mallopt", _TRIM_THRESHOLD, _ANY_BYTES)


def give_back() -> None:
    """Give back every page that nothing lies on any more; takes a fraction of a millisecond."""
    _glibc("malloc_trim", 0)


def _glibc(name: str, *arguments: int) -> None:
    """Call a function of glibc; another C library has its own ways."""
    function: Callable[..., object] | None = getattr(ctypes.CDLL(None), name, None)
    if function is not None:
        function(*arguments)
