"""What `limbd compile` goes through is all that a stream needs."""

import numpy as np

from arm.arm_file import load_arm
from arm.counts import COUNT_M_S2
from daemon.service.kernels import compile_all
from daemon.virtual_device.virtual_motion import BenchPlan, stretches
from tests.daemon.pipeline.test_warm_up import compiled_signatures, kernels
from tracking.tracker import Method, tracker_of

RATE_HZ = 4000.0


def test_nothing_is_left_to_compile() -> None:
    for kernel in kernels().values():  # what other tests compiled does not count
        kernel._reset_overloads()
    compile_all()
    before = compiled_signatures()
    arm = load_arm("dd-arm")
    plan = BenchPlan(arm, seed=1, rate_hz=RATE_HZ, trials=1)
    a = COUNT_M_S2 * np.concatenate([s.counts for s, _ in zip(stretches(plan), range(2), strict=False)])
    methods: tuple[Method, ...] = ("filter", "integrate")
    for method in methods:
        tracker = tracker_of(arm, method, RATE_HZ)
        for at in range(0, len(a), 40):
            tracker.push(round(at / RATE_HZ * 1e9), a[at : at + 40])
    assert compiled_signatures() == before
