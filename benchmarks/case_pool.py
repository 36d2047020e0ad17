"""Cases run by processes; what is done is reported at once, whatever happens to the processes that run them."""

import contextlib
import multiprocessing
import os
import signal
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from types import FrameType
from typing import Any, Protocol, TypeVar

import fitter.single_thread  # noqa: F401 - the processes that it starts inherit it
from fitter.parallel.processors import work_alone
from fitter.parallel.spawned import be_worker

Line = dict[str, Any]

#: A case that was under way when a process died is tried so often.
_TRIES = 2


class Job(Protocol):
    """A case before it is run."""

    @property
    def key(self) -> str:
        """What a results file calls it."""
        ...


SomeJob = TypeVar("SomeJob", bound=Job)


@dataclass(frozen=True)
class Guarded:
    """A case's work that always gives a line: one that fails or takes too long has an ``error``."""

    work: Callable[[Any], Line]
    limit_s: float

    def __call__(self, job: Job) -> Line:
        """Run a case."""
        line: Line = {"key": job.key}
        try:
            with at_most(self.limit_s):
                return line | self.work(job)
        except Exception:  # a benchmark of hundreds goes on: the line says what went wrong
            return line | {"error": traceback.format_exc()}


def run_all(
    todo: Sequence[SomeJob], run: Callable[[SomeJob], Line], workers: int
) -> Iterator[tuple[SomeJob, Line]]:
    """Yield cases and their lines as they are done."""
    spawn, tries = multiprocessing.get_context("spawn"), dict.fromkeys(todo, 0)
    while tries:
        with ProcessPoolExecutor(workers, mp_context=spawn, initializer=_begin, initargs=(workers,)) as pool:
            futures = {pool.submit(run, job): job for job in tries}
            for future in as_completed(futures):
                job = futures[future]
                try:
                    line = future.result()
                except BrokenProcessPool:
                    continue  # the others that waited in this pool end here too: a new one takes them
                del tries[job]
                yield job, line
        begun = list(tries)[:workers]  # in order of submission, so these were under way when the process died
        for job in begun:
            tries[job] += 1
            if tries[job] >= _TRIES:
                del tries[job]
                yield job, {"key": job.key, "error": "the process that ran it died"}


def _begin(workers: int) -> None:
    be_worker()
    if workers > 1:
        work_alone()


def timed(work: Callable[[], Any]) -> tuple[Any, dict[str, float]]:
    """Return what work makes, and the ``seconds`` and ``processor_s`` that it takes."""
    begin, used_s = time.perf_counter(), _processor_s()
    made = work()
    return made, {"seconds": time.perf_counter() - begin, "processor_s": _processor_s() - used_s}


def _processor_s() -> float:
    """Return the processor time [s] of this process and of those it has ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


@contextlib.contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Raise `TimeoutError` in the main thread after this many seconds."""

    def late(_signum: int, _frame: FrameType | None) -> None:
        raise TimeoutError(f"not done after {seconds:g} s")

    previous = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, previous)
