"""Signals become something to wait for."""

import os
import signal
from select import select

import pytest

from daemon.process.stop_signal import StopSignal


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_is_noted_once_and_handlers_come_back(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    with StopSignal() as stop:
        assert not stop.came
        assert not select([stop], [], [], 0)[0]
        os.kill(os.getpid(), number)
        os.kill(os.getpid(), number)
        assert select([stop], [], [], 30)[0] == [stop]
        assert stop.came
    assert signal.getsignal(number) is before
