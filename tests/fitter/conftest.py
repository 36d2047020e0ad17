"""Trials of the standard bench, free of noise."""

from dataclasses import replace

import pytest

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.kinematics import tip_position
from fitter.data.trial import Trial


@pytest.fixture(scope="session")
def bench_trials() -> list[Trial]:
    """Six trials of the standard bench at 500 Hz, free of noise, with torque, target and tip."""
    arm = load_arm("dd-arm")
    bench = replace(Bench(), rate_hz=500.0, learning=4, evaluating=2)
    return [
        Trial(f"bench#{i}", m.t, 0.002, m.q, m.dq, m.ddq, m.tau, m.ref, tip_position(arm, m.q))
        for i, m in enumerate(motions(arm, bench, 1))
    ]
