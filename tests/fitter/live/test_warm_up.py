"""After a warm-up nothing is left to be compiled while a stream is followed."""

import sys

from numba.core.dispatcher import Dispatcher

from fitter.live.calibration import Calibration
from fitter.live.stream import MotionAssembler
from fitter.live.warm_up import warm_up


def kernels():
    """Return every kernel that was loaded."""
    return {
        f"{name}.{kernel.py_func.__name__}": kernel
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] in ("arm", "tracking", "fitter")
        for kernel in vars(module).values()
        if isinstance(kernel, Dispatcher)
    }


def signatures():
    return {name: len(kernel.signatures) for name, kernel in kernels().items()}


def test_following_compiles_nothing_more(short_run):
    for kernel in kernels().values():  # what other tests compiled does not count
        kernel._reset_overloads()
    warm_up.cache_clear()
    warm_up()
    before = signatures()
    assembler, calibration = MotionAssembler(), Calibration(short_run.arm)
    for message in short_run.messages:
        motion = assembler.feed(*message)
        if motion is not None and calibration.add(motion).role == "learn":
            calibration.learn_dynamics()
    calibration.conclude()
    for role in ("learn", "evaluate"):
        calibration.scores(role)
    assert {name: n for name, n in signatures().items() if n != before.get(name, 0)} == {}
