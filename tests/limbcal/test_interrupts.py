"""SIGINT is held while a process is started, and comes when that has ended."""

import signal
import subprocess
import sys

import pytest

from limbcal.interrupts import interrupts_held
from tests.patience import PATIENCE_S

#: In a process of its own: a signal goes to any thread that does not block it, and others may have left some here.
HOLDING = """
import os, signal
from limbcal.interrupts import interrupts_held
held = False
try:
    with interrupts_held():
        os.kill(os.getpid(), signal.SIGINT)
        held = True
except KeyboardInterrupt:
    print("held" if held else "not held", flush=True)
"""


def test_a_ctrl_c_comes_when_it_is_no_longer_held():
    command = [sys.executable, "-c", HOLDING]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE_S)
    assert (done.returncode, done.stdout) == (0, "held\n")


def test_the_mask_is_as_it_was_even_after_an_error():
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    with pytest.raises(ValueError, match="start"), interrupts_held():
        assert signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())
        raise ValueError("start")
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == before
