"""One job after the other, or several at a time: in processes of this machine or on a Dask cluster.

Results come in the order of the jobs whoever did them, so whatever is made of them in that order is the same.
"""

import multiprocessing
import queue
import signal
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from fitter.parallel.dask_cluster import on_cluster
from limbcal.errors import DeviceError
from limbcal.interrupts import interrupts_held
from limbcal.parent import end_with

Job = TypeVar("Job")
Result = TypeVar("Result")

#: Hears what a job tells of itself.
Hear = Callable[..., None]

#: How often what jobs tell is passed on [s]: often enough for a person who watches.
_POLL_S = 0.1

#: Where what this process's job tells goes; empty where nobody hears.
_hearers: list[Hear] = []


def tell(*said: object) -> None:
    """Tell the process that waits for this job something; it is lost where nobody there hears."""
    for hear in _hearers:
        hear(*said)


def in_order(
    work: Callable[[Job], Result],
    jobs: Sequence[Job],
    workers: int = 1,
    dask: str | None = None,
    hear: Hear | None = None,
) -> Generator[Result, None, None]:
    """Do some jobs and yield their results in order.

    Parameters
    ----------
    work : callable
        What is done with a job; with workers it must be importable, as a function of a module is.
    jobs : sequence
    workers : int
        Processes; 1 is this one.
    dask : str, optional
        Address of a Dask scheduler, such as ``tcp://127.0.0.1:8786``, to whose workers the jobs go instead. They
        need this package, and to see the files under the same names.
    hear : callable, optional
        Called here with what jobs `tell`; those of a cluster tell nothing.

    Raises
    ------
    LimbcalError
        What a job raises; those that remain are not begun.
    ConfigError
        If Dask is asked for and not installed, or its address is none.
    DeviceError
        If a process dies, nobody answers at the address, or the cluster fails.
    """
    if dask is not None:
        yield from on_cluster(work, jobs, dask)
    elif workers > 1 and len(jobs) > 1:
        yield from _in_processes(work, jobs, min(workers, len(jobs)), hear)
    else:
        for job in jobs:
            before, _hearers[:] = list(_hearers), [] if hear is None else [hear]
            try:
                result = work(job)
            finally:
                _hearers[:] = before
            yield result


def _in_processes(
    work: Callable[[Job], Result], jobs: Sequence[Job], workers: int, hear: Hear | None
) -> Generator[Result, None, None]:
    # Spawned, not forked: a fork of a program with threads may hang, and copies what it should not have.
    context = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    reports = None if hear is None else context.Queue()
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_begin, initargs=(reports,))
    done = False
    try:
        with interrupts_held():
            futures = [pool.submit(work, job) for job in jobs]
        for future in futures:
            if hear is not None and reports is not None:
                while not future.done():
                    wait([future], _POLL_S)
                    _pass_on(reports, hear)
            yield future.result()
        done = True
    except BrokenProcessPool as error:
        raise DeviceError("a worker process ended without a word; perhaps memory ran out") from error
    finally:
        if not done:  # stopped or failed: nobody waits for what the others are at
            for process in set(multiprocessing.active_children()) - others:
                process.terminate()
        pool.shutdown(wait=True, cancel_futures=True)  # its own thread joins them; two would race
    if hear is not None and reports is not None:
        _pass_on(reports, hear)  # the last words


def _pass_on(reports: "multiprocessing.Queue[tuple[Any, ...]]", hear: Hear) -> None:
    """Hand on what jobs have reported."""
    try:
        while True:
            hear(*reports.get_nowait())
    except queue.Empty:
        pass


def _begin(reports: "multiprocessing.Queue[tuple[Any, ...]] | None") -> None:
    be_worker()
    if reports is not None:
        _hearers.append(lambda *said: reports.put(said))


def be_worker() -> None:
    """Leave Ctrl-C to the process that hands out the jobs, and end with it however it ends, whatever the job."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    if parent is not None and parent.pid is not None:
        end_with(parent.pid)
