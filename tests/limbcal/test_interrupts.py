"""SIGINT is held while a process is started, and comes when that has ended."""

import os
import signal

import pytest

from limbcal.interrupts import interrupts_held


def test_a_ctrl_c_comes_when_it_is_no_longer_held():
    held = False
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012 - it comes at the end of the inner block
        with interrupts_held():
            os.kill(os.getpid(), signal.SIGINT)
            held = True
    assert held


def test_the_mask_is_as_it_was_even_after_an_error():
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    with pytest.raises(ValueError, match="start"), interrupts_held():
        assert signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())
        raise ValueError("start")
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == before
