"""Processes that end with the one that started them."""

import ctypes
import os
import signal

_PR_SET_PDEATHSIG = 1  # prctl(2)


def end_with(parent: int) -> None:
    """Have this process killed when the one that started it ends, however that ends and whatever this one is at.

    The system does it: a process that computes for minutes has no thread that could look. Whose end counts is the
    thread that started this process, and it must outlive what it waits for.

    Parameters
    ----------
    parent : int
        Number of the process that started this one.
    """
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it ended before it could be asked for
        os._exit(1)
