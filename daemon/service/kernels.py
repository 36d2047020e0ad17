"""Going through what the daemon does, so that all kernels are compiled."""

from typing import get_args

import numpy as np

from arm.arm_file import load_arm
from daemon.acquisition.ring import Chunk
from daemon.pipeline.warm_up import warm_up
from daemon.reception.reception import Reception
from daemon.virtual_device.bench_plan import BenchPlan
from daemon.virtual_device.virtual_device import FRAME_SAMPLES, TICK_HZ, device_info
from daemon.virtual_device.virtual_motion import stretches
from protocol.serial_frame import InfoFrame, encode_samples
from protocol.serial_parser import FrameParser
from tracking.tracker import Method, tracker_of

#: Rate [Hz] and number of the frames that go through reception: any will do, for each kernel is compiled once.
_RATE_HZ = 4000.0
_FRAMES = 20


def compile_all() -> None:
    """Go through what the virtual device, the reception and either tracker do, with an arm of no interest."""
    arm, rate_hz = load_arm("dd-arm"), _RATE_HZ
    plan = BenchPlan(arm, seed=0, rate_hz=rate_hz, trials=1)
    for _ in zip(stretches(plan), range(2), strict=False):
        continue
    info = device_info(arm, rate_hz, plan.seed)
    reception = Reception(FrameParser(), InfoFrame(0, 0, info))
    counts = np.zeros((FRAME_SAMPLES, len(info.channels)), dtype=np.int16)
    ticks = round(TICK_HZ * FRAME_SAMPLES / rate_hz)
    frames = b"".join(encode_samples(counts, k + 1, k * ticks) for k in range(_FRAMES))
    reception.take([Chunk(1, frames)])
    for method in get_args(Method):
        warm_up(tracker_of(arm, method, rate_hz), arm, rate_hz, None)
