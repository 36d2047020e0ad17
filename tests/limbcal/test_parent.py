"""A process ends with the one that started it, whatever it is at."""

import os
import signal
import subprocess
import sys

import pytest

from tests.patience import PATIENCE_S

#: A process that starts another; that one says that it is there, and then computes without ever looking up.
PROGRAM = """
import itertools, os, sys
from limbcal.parent import end_with

parent = os.getpid()
if os.fork() == 0:
    end_with(parent + int(sys.argv[1]))
    print("at work", flush=True)
    sum(itertools.repeat(0))
else:
    os.wait()
"""


@pytest.mark.parametrize("sign", [signal.SIGTERM, signal.SIGKILL])
def test_one_that_looks_at_nothing_ends_with_its_parent(sign: signal.Signals) -> None:
    reading, writing = os.pipe()
    with (
        open(reading, "rb") as line,
        subprocess.Popen([sys.executable, "-c", PROGRAM, "0"], stdout=writing) as process,
    ):
        os.close(writing)
        assert line.readline() == b"at work\n"
        process.send_signal(sign)
        assert process.wait(PATIENCE_S) == -sign
        assert line.read() == b""  # nobody holds the other end any more


def test_one_whose_parent_is_gone_already_ends_at_once() -> None:
    command = [sys.executable, "-c", PROGRAM, "1"]
    done = subprocess.run(command, capture_output=True, timeout=PATIENCE_S, check=True)
    assert done.stdout == b""
