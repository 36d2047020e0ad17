"""One job after the other, or several at a time: in processes of this machine or on a Dask cluster.

Results come in the order of the jobs whoever did them, so whatever is made of them in that order is the same.
"""

import multiprocessing
import signal
import socket
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import CancelledError, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from typing import TypeVar
from urllib.parse import urlsplit

from limbcal.errors import ConfigError, DeviceError
from limbcal.interrupts import interrupts_held
from limbcal.parent import end_with

Job = TypeVar("Job")
Result = TypeVar("Result")

#: How long a scheduler may take to answer.
_CONNECT_S = 10.0


def in_order(
    work: Callable[[Job], Result], jobs: Sequence[Job], workers: int = 1, dask: str | None = None
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
        yield from _on_cluster(work, jobs, dask)
    elif workers > 1 and len(jobs) > 1:
        yield from _in_processes(work, jobs, min(workers, len(jobs)))
    else:
        yield from map(work, jobs)


def _in_processes(
    work: Callable[[Job], Result], jobs: Sequence[Job], workers: int
) -> Generator[Result, None, None]:
    # Spawned, not forked: a fork of a program with threads may hang, and copies what it should not have.
    context = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=be_worker)
    done = False
    try:
        with interrupts_held():
            futures = [pool.submit(work, job) for job in jobs]
        for future in futures:
            yield future.result()
        done = True
    except BrokenProcessPool as error:
        raise DeviceError("a worker process ended without a word; perhaps memory ran out") from error
    finally:
        if not done:  # stopped or failed: nobody waits for what the others are at
            for process in set(multiprocessing.active_children()) - others:
                process.terminate()
        pool.shutdown(wait=True, cancel_futures=True)  # its own thread joins them; two would race


def be_worker() -> None:
    """Leave Ctrl-C to the process that hands out the jobs, and end with it however it ends, whatever the job."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    if parent is not None and parent.pid is not None:
        end_with(parent.pid)


def _on_cluster(work: Callable[[Job], Result], jobs: Sequence[Job], address: str) -> Generator[Result, None, None]:
    try:
        distributed = import_module("distributed")
    except ImportError as error:
        raise ConfigError(
            "--dask needs the packages dask and distributed, which are not installed; "
            "pip install 'limbcal[cluster]' adds them"
        ) from error
    _require_somebody(address)
    with distributed.Client(address, timeout=_CONNECT_S, set_as_default=False) as client:
        futures = client.map(work, jobs, pure=False)
        try:
            for future in futures:
                yield future.result()
        except (OSError, ImportError, CancelledError, distributed.KilledWorker) as error:
            raise DeviceError(f"--dask {address}: the cluster could not do it ({error})") from error
        finally:
            client.cancel(futures)


def _require_somebody(address: str) -> None:
    """Look whether anybody listens at all; the client would try for long, and go on trying behind our back."""
    parts = urlsplit(address)
    try:
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if host is None or port is None:
        raise ConfigError(f"--dask is {address!r}, expected a scheduler's address such as tcp://127.0.0.1:8786")
    try:
        socket.create_connection((host, port), timeout=_CONNECT_S).close()
    except OSError as error:
        raise DeviceError(f"--dask {address}: no Dask scheduler answers there ({error})") from error
