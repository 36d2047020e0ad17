"""Jobs in order: here, in processes, on a cluster."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from contextlib import closing
from operator import neg

import psutil
import pytest

from fitter.parallel.spawned import in_order, tell
from limbcal.errors import DataError, DeviceError
from tests.patience import PATIENCE_S

#: Every job of this program waits for ever, once it has said that it is there.
STUCK = """
import os, sys, threading
from fitter.parallel.spawned import in_order

def work(job):
    open(os.path.join(sys.argv[1], str(os.getpid())), "w").close()
    threading.Event().wait()

if __name__ == "__main__":
    try:
        list(in_order(work, range(4), workers=2))
    except KeyboardInterrupt:
        print("stopped")
"""


def leave(_job):
    os._exit(7)


def tell_twice(job):
    tell("begins", job)
    tell("ends", job)
    return job


def refuse(job):
    raise DataError(f"{job}: no good")


@pytest.mark.parametrize("workers", [1, 2])
def test_results_come_in_the_order_of_the_jobs(workers):
    assert list(in_order(neg, range(7), workers)) == [-k for k in range(7)]
    assert not multiprocessing.active_children()


def test_what_a_job_raises_comes_through_and_leaves_no_process():
    with pytest.raises(DataError, match="3: no good"), closing(in_order(refuse, [3, 4], 2)) as results:
        list(results)
    assert not multiprocessing.active_children()


@pytest.mark.parametrize("workers", [1, 2])
def test_what_jobs_tell_is_heard_here_in_the_order_of_each(workers):
    heard = []
    assert list(in_order(tell_twice, range(4), workers, hear=lambda *said: heard.append(said))) == [0, 1, 2, 3]
    assert sorted(heard) == sorted([(what, job) for job in range(4) for what in ("begins", "ends")])
    assert all(heard.index(("begins", job)) < heard.index(("ends", job)) for job in range(4))


@pytest.mark.parametrize("workers", [1, 2])
def test_where_nobody_hears_a_job_may_tell(workers):
    tell("nobody waits")
    assert list(in_order(tell_twice, [1, 2], workers)) == [1, 2]


def test_a_process_that_dies_is_said():
    with pytest.raises(DeviceError, match="ended without a word"):
        list(in_order(leave, [1, 2], 2))
    assert not multiprocessing.active_children()


@pytest.mark.parametrize("sign", [signal.SIGINT, signal.SIGKILL])
def test_no_process_outlives_the_one_that_handed_out_the_jobs(tmp_path, sign):
    program = tmp_path / "stuck.py"
    program.write_text(STUCK)
    at_work = tmp_path / "at_work"
    at_work.mkdir()
    with subprocess.Popen([sys.executable, program, at_work], stdout=subprocess.PIPE, text=True) as process:
        until = time.monotonic() + 60.0
        while len(list(at_work.iterdir())) < 2 and time.monotonic() < until:
            os.sched_yield()
        children = psutil.Process(process.pid).children(recursive=True)
        process.send_signal(sign)
        said = process.communicate(timeout=PATIENCE_S)[0]
    assert {int(path.name) for path in at_work.iterdir()} <= {child.pid for child in children}
    assert psutil.wait_procs(children, timeout=PATIENCE_S)[1] == []
    if sign == signal.SIGINT:
        assert (process.returncode, said) == (0, "stopped\n")
