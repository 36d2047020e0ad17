"""Jobs in order: here, in processes, on a cluster."""

import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import closing
from operator import neg

import psutil
import pytest

from fitter.parallel import in_order
from limbcal.errors import ConfigError, DataError, DeviceError
from tests.patience import PATIENCE_S

#: Every job of this program waits for ever, once it has said that it is there.
STUCK = """
import os, sys, threading
from fitter.parallel import in_order

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


def test_a_cluster_that_is_not_there_is_said():
    pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(DeviceError, match="no Dask scheduler answers"):
        list(in_order(neg, [1], dask=f"tcp://127.0.0.1:{port}"))
    for address in ("nonsense", "tcp://127.0.0.1", "tcp://127.0.0.1:nonsense"):
        with pytest.raises(ConfigError, match="expected a scheduler's address"):
            list(in_order(neg, [1], dask=address))


def test_a_missing_extra_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match=r"pip install 'limbcal\[cluster\]'"):
        list(in_order(neg, [1], dask="tcp://127.0.0.1:8786"))
