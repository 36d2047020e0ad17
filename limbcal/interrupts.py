"""Ctrl-C goes to every process of a terminal; a process that is being started must not take it for its own."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Hold SIGINT back here until the end, and for good in processes that are started meanwhile.

    A process that is spawned loads modules for a second before it gets to say what it does with the signal, and
    would end with a traceback. What it inherits blocked it never sees: its parent acts on a Ctrl-C, which it
    gets as soon as this has ended, and stops it.
    """
    resource_tracker.ensure_running()  # the first process that is spawned starts it, and then lets SIGINT through
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT,))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
