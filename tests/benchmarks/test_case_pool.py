"""A case always gives a line, whatever comes of it."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil
import pytest

from benchmarks.case_pool import Guarded, timed
from tests.patience import PATIENCE_S


@dataclass(frozen=True)
class Job:
    key: str = "one/cogging/3"


def test_a_case_that_fails_or_takes_too_long_has_an_error() -> None:
    def fail(_job: Job) -> dict[str, Any]:
        raise ValueError("no arm")

    assert Guarded(lambda _job: {"said": "none"}, 60.0)(Job()) == {"key": "one/cogging/3", "said": "none"}
    assert "no arm" in Guarded(fail, 60.0)(Job())["error"]
    assert "not done after 0.001 s" in Guarded(lambda _job: time.sleep(60.0) or {}, 0.001)(Job())["error"]


def test_what_was_made_comes_with_its_times() -> None:
    made, took = timed(lambda: 3)
    assert made == 3
    assert set(took) == {"seconds", "processor_s"}


#: Every case of this benchmark says that it is there, and then computes without ever looking up.
STUCK = """
import itertools, os, sys
from dataclasses import dataclass
from benchmarks.case_pool import run_all

@dataclass(frozen=True)
class Job:
    key: str

def work(job):
    open(os.path.join(sys.argv[1], str(os.getpid())), "w").close()
    sum(itertools.repeat(0))

if __name__ == "__main__":
    list(run_all([Job("a"), Job("b")], work, 1))
"""


@pytest.mark.parametrize("sign", [signal.SIGTERM, signal.SIGKILL])
def test_no_case_outlives_a_benchmark_that_is_killed(tmp_path: Path, sign: signal.Signals) -> None:
    program, at_work = tmp_path / "stuck.py", tmp_path / "at_work"
    program.write_text(STUCK)
    at_work.mkdir()
    paths = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen([sys.executable, program, at_work], env=paths) as process:
        until_s = time.monotonic() + PATIENCE_S
        while not any(at_work.iterdir()) and time.monotonic() < until_s:
            os.sched_yield()
        children = psutil.Process(process.pid).children(recursive=True)
        process.send_signal(sign)
        assert process.wait(PATIENCE_S) == -sign
    assert {int(path.name) for path in at_work.iterdir()} <= {child.pid for child in children}
    assert psutil.wait_procs(children, timeout=PATIENCE_S)[1] == []
