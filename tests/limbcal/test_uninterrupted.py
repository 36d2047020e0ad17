"""The compiler is not interrupted; what wanted to is heard afterwards."""

import signal
import threading

import numba
import pytest
from numba.core import types
from numba.extending import intrinsic

import limbcal.kernel_cache  # noqa: F401 - from then on
from limbcal.uninterrupted import SignalsLater


@pytest.fixture
def heard():
    """Return the signals that a program hears of, as they come."""
    came = []
    before = {
        number: signal.signal(number, lambda number, _: came.append(number))
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    yield came
    for number, handler in before.items():
        signal.signal(number, handler)


def interrupted_kernel(number):
    """Return a kernel that gives 2 x + 1, while the compilation of which a signal comes."""

    @intrinsic
    def doubled(_context, x):
        def generate(_context, builder, _signature, arguments):
            signal.raise_signal(number)
            return builder.fadd(arguments[0], arguments[0])

        return types.float64(types.float64), generate

    return numba.njit(lambda x: doubled(x) + 1.0)


def test_ctrl_c_while_a_kernel_is_compiled_comes_after_it():
    kernel = interrupted_kernel(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        kernel(1.0)
    assert len(kernel.signatures) == 1
    assert kernel(1.5) == 4.0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_is_heard_once_when_all_is_done(heard, number):
    later = SignalsLater()
    later.on_start(None)
    later.on_start(None)
    signal.raise_signal(number)
    later.on_end(None)
    signal.raise_signal(number)
    assert heard == []
    later.on_end(None)
    assert heard == [number]
    signal.raise_signal(number)
    assert heard == [number, number]


def test_both_signals_are_heard_in_the_order_they_came(heard):
    later = SignalsLater()
    later.on_start(None)
    signal.raise_signal(signal.SIGTERM)
    signal.raise_signal(signal.SIGINT)
    later.on_end(None)
    assert heard == [signal.SIGTERM, signal.SIGINT]


def test_what_is_ignored_stays_ignored(heard):
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    later = SignalsLater()
    later.on_start(None)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    signal.raise_signal(signal.SIGINT)
    later.on_end(None)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    assert heard == []


def test_other_threads_put_nothing_off(heard):
    later = SignalsLater()
    before = signal.getsignal(signal.SIGINT)
    kept = []

    def compile_there():
        later.on_start(None)
        kept.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=compile_there)
    thread.start()
    thread.join()
    assert kept == [before]
    later.on_start(None)
    thread = threading.Thread(target=later.on_end, args=(None,))
    thread.start()
    thread.join()
    signal.raise_signal(signal.SIGINT)
    assert heard == []
    later.on_end(None)
    assert heard == [signal.SIGINT]
