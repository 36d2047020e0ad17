"""All of the paper's experiments: which there are, and running several of them side by side."""

import multiprocessing
import os
import queue
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

import fitter.single_thread  # noqa: F401 - the processes that it starts inherit it
from fitter.report.figures import png
from limbcal.errors import LimbcalError
from limbcal.parent import end_with
from reproduction import fig6, fig7, fig8, table1, table2, table3, table4, table5, table6
from reproduction.experiment import Experiment, Settings

#: In the paper's order.
EXPERIMENTS: dict[str, ModuleType] = {
    "table1": table1,
    "table2": table2,
    "table3": table3,
    "table4": table4,
    "table5": table5,
    "table6": table6,
    "fig6": fig6,
    "fig7": fig7,
    "fig8": fig8,
}
#: Those that share the readings of the sensed bench run in one process, which keeps them; the longest come first.
_TOGETHER = (
    ("table1",),
    ("fig8", "fig7", "table2"),
    ("fig6",),
    ("table3",),
    ("table6",),
    ("table5",),
    ("table4",),
)
_POLL_S = 0.1

#: Told an experiment's name, and what is being done.
Progress = Callable[[str, str], None]


@dataclass(frozen=True)
class Outcome:
    """What came of an experiment: its tables and its pictures as PNG; or why there are none.

    Attributes
    ----------
    name : str
    experiment : Experiment or None
        Its figures stay where it was run.
    pictures : tuple of (bytes, str)
        PNG and caption.
    error : LimbcalError or None
    """

    name: str
    experiment: Experiment | None
    pictures: tuple[tuple[bytes, str], ...] = ()
    error: LimbcalError | None = None


def reproduce(names: Sequence[str], settings: Settings, jobs: int, progress: Progress) -> list[Outcome]:
    """Run some experiments.

    Parameters
    ----------
    names : sequence of str
        Of `EXPERIMENTS`.
    settings : Settings
        Its own ``progress`` is not used.
    jobs : int
        Processes, of which no more are started than there are groups of experiments that share their data.
    progress : callable

    Returns
    -------
    list of Outcome
        In the paper's order. One that failed does not stop the others.
    """
    groups = [tuple(name for name in group if name in names) for group in _TOGETHER]
    groups = [group for group in groups if group]
    if jobs > 1 and len(groups) > 1:
        found = list(_side_by_side(groups, settings, min(jobs, len(groups)), progress))
    else:
        found = [outcome for group in groups for outcome in _run_group(group, settings, progress)]
    order = list(EXPERIMENTS)
    return sorted(found, key=lambda outcome: order.index(outcome.name))


def run_one(name: str, settings: Settings) -> Outcome:
    """Run one experiment and render its pictures."""
    run: Callable[[Settings], Experiment] = EXPERIMENTS[name].run
    try:
        found = run(settings)
    except LimbcalError as error:
        return Outcome(name, None, error=error)
    pictures = tuple((png(picture.figure), picture.caption) for picture in found.pictures)
    return Outcome(name, replace(found, pictures=()), pictures)


def _run_group(names: Sequence[str], settings: Settings, progress: Progress) -> list[Outcome]:
    outcomes = []
    for name in names:

        def said(what: str, of: str = name) -> None:
            progress(of, what)

        outcomes.append(run_one(name, replace(settings, progress=said)))
        progress(name, "")
    return outcomes


def _side_by_side(
    groups: Sequence[Sequence[str]], settings: Settings, jobs: int, progress: Progress
) -> Iterator[Outcome]:
    spawn = multiprocessing.get_context("spawn")
    reports = spawn.Queue()
    plain = replace(settings, progress=_Reports.nothing)
    with ProcessPoolExecutor(jobs, spawn, _Reports.begin, (reports, os.getpid())) as pool:
        try:
            running: set[Future[list[Outcome]]] = {pool.submit(_in_worker, group, plain) for group in groups}
            while running:
                done, running = wait(running, _POLL_S, FIRST_COMPLETED)
                _pass_on(reports, progress)
                for future in done:
                    yield from future.result()
        except BaseException:  # a stop that was asked for must not wait for an experiment's end
            for child in multiprocessing.active_children():
                child.terminate()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
    _pass_on(reports, progress)


def _pass_on(reports: "multiprocessing.Queue[tuple[str, str]]", progress: Progress) -> None:
    while True:
        try:
            progress(*reports.get_nowait())
        except queue.Empty:
            return


class _Reports:
    """The way back to the process that waits, of one worker."""

    queue: Any = None

    @staticmethod
    def begin(reports: Any, parent: int) -> None:
        """Remember where progress goes, and end with who waits for it."""
        _Reports.queue = reports
        end_with(parent)

    @staticmethod
    def nothing(_what: str) -> None:
        """Say nothing."""

    @staticmethod
    def say(name: str, what: str) -> None:
        """Send a message."""
        _Reports.queue.put((name, what))


def _in_worker(names: Sequence[str], settings: Settings) -> list[Outcome]:
    return _run_group(names, settings, _Reports.say)
