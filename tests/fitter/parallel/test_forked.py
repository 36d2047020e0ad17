"""Work shared with forked processes comes back whole and in order, whatever becomes of them."""

import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fitter.parallel.forked import side_by_side


@pytest.fixture(autouse=True)
def three_processors(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As many, wherever the tests run, whose own threads do not count; and no process is left behind."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _process: {0, 1, 2})
    monkeypatch.setattr(threading, "active_count", lambda: 1)
    before = children()
    yield
    assert children() <= before


def children() -> set[int]:
    """Return the processes of this one, waited for or not; others' tests may have left some to the end."""
    tasks = Path("/proc/self/task").glob("*/children")
    return {int(pid) for task in tasks for pid in task.read_text().split()}


@pytest.fixture
def met() -> Iterator[Callable[[], bool]]:
    """Return what waits until two processes are at work, and says whether this is the first of them."""
    here, mine, other = os.getpid(), *socket.socketpair()

    def wait() -> bool:
        end = mine if os.getpid() == here else other
        end.send(b"!")
        end.recv(1)
        return end is mine

    yield wait
    mine.close()
    other.close()


def test_the_results_come_in_order_and_from_more_than_one_process(met: Callable[[], bool]) -> None:
    found = side_by_side(lambda k: (k * k, met()), range(2))
    assert [square for square, _ in found] == [0, 1]
    assert {here for _, here in found} == {True, False}


@pytest.mark.parametrize("count", [0, 1, 2, 50])
def test_any_number_of_items(count: int) -> None:
    progress: list[tuple[int, int]] = []
    assert side_by_side(lambda k: [k] * 30_000, range(count), lambda *now: progress.append(now)) == [
        [k] * 30_000 for k in range(count)
    ]
    assert progress == sorted(progress)
    assert all(begun <= total == count for begun, total in progress)


def test_an_error_anywhere_is_raised_here() -> None:
    with pytest.raises(ZeroDivisionError):
        side_by_side(lambda k: 1 / (k - 3), range(6))


def test_what_another_process_raises_is_raised_here(met: Callable[[], bool]) -> None:
    def work(k: int) -> int:
        if not met():
            raise LookupError(f"item {k}")
        return k

    with pytest.raises(LookupError, match="item"):
        side_by_side(work, range(2))


def test_what_a_killed_process_had_taken_is_done_here(met: Callable[[], bool]) -> None:
    alone: list[int] = []

    def work(k: int) -> int:
        if not alone and not met():
            os.kill(os.getpid(), signal.SIGKILL)
        alone.append(k)
        return -k

    assert side_by_side(work, range(2)) == [0, -1]


def test_who_is_interrupted_ends_the_others() -> None:
    here = os.getpid()

    def work(_: int) -> None:
        if os.getpid() != here:
            signal.pause()

    def interrupted(_begun: int, _total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        side_by_side(work, range(30), interrupted)


def test_another_process_shares_its_own_work_with_nobody(met: Callable[[], bool]) -> None:
    def work(_: int) -> bool:
        here = os.getpid()
        return met() or set(side_by_side(lambda _: os.getpid(), range(20))) == {here}

    assert side_by_side(work, range(2)) == [True, True]


def test_beside_another_thread_nothing_is_forked(monkeypatch: pytest.MonkeyPatch) -> None:
    over = threading.Event()
    thread = threading.Thread(target=over.wait)
    monkeypatch.setattr(threading, "active_count", lambda: len(threading.enumerate()))
    thread.start()
    try:
        assert side_by_side(lambda _: os.getpid(), range(20)) == [os.getpid()] * 20
    finally:
        over.set()
        thread.join()
