"""After a warm-up nothing is left to be compiled while samples come in."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

from arm.arm_file import load_arm
from arm.counts import COUNT_M_S2
from arm.model import Arm
from daemon.acquisition.ring import Chunk
from daemon.pipeline.warm_up import warm_up
from daemon.reception.reception import Reception
from daemon.virtual_device.virtual_motion import BenchPlan, stretches
from protocol import serial_scan
from protocol.serial_frame import InfoFrame, encode_samples
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info, resting_counts
from tracking.tracker import Method, tracker_of

RATE_HZ = 4000.0


def kernels() -> dict[str, Dispatcher]:
    """Return every kernel that samples go through."""
    return {
        f"{name}.{kernel.py_func.__name__}": kernel
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] in ("arm", "tracking", "protocol", "daemon")
        for kernel in vars(module).values()
        if isinstance(kernel, Dispatcher)
    }


def compiled_signatures() -> dict[str, int]:
    """Count the signatures that each kernel of ours has been compiled, or loaded, for."""
    return {name: len(kernel.signatures) for name, kernel in kernels().items()}


def coupled(arm: Arm) -> Arm:
    return replace(arm, sensors=tuple(replace(sensor, highpass_hz=0.05) for sensor in arm.sensors))


@pytest.mark.parametrize("method", ["filter", "integrate"])
@pytest.mark.parametrize("arm", [load_arm("dd-arm"), coupled(load_arm("dd-arm"))], ids=["dc", "ac"])
def test_a_motion_and_a_gap_compile_nothing_more(method: Method, arm: Arm) -> None:
    plan = BenchPlan(arm, seed=1, rate_hz=RATE_HZ, trials=1)
    a = COUNT_M_S2 * np.concatenate([s.counts for s, _ in zip(stretches(plan), range(2), strict=False)])
    for kernel in kernels().values():  # what other tests compiled does not count
        kernel._reset_overloads()
    warm_up(tracker_of(arm, method, RATE_HZ), arm, RATE_HZ, None)
    before = compiled_signatures()
    tracker = tracker_of(arm, method, RATE_HZ)
    phases = []
    lost = {3000: 400, 20_000: 8000}  # a gap that the filter bridges, and one that is too long for it
    at = 0
    while at < len(a):
        if at in lost:
            phases += tracker.gap(lost[at])[1]
            at += lost[at]
        phases += tracker.push(round(at / RATE_HZ * 1e9), a[at : at + 40])[1]
        at += 40
    tracker.flush()
    assert {phase.kind for phase in phases} >= {"begin"}
    assert compiled_signatures() == before


def test_what_samples_go_through_before_compiles_nothing_more() -> None:
    for kernel in kernels().values():
        kernel._reset_overloads()
    serial_scan.warm_up.cache_clear()
    taker = Reception(FrameParser(), InfoFrame(0, 0, device_info()))
    before = compiled_signatures()
    frames = [encode_samples(resting_counts(32), k + 1, 4000 * k) for k in range(20)]
    (run,) = taker.take([Chunk(1, b"".join(frames))])
    assert len(run.a) == 640
    assert compiled_signatures() == before
