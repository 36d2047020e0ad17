"""Bench readings with something wrong in them, put there without the program's own effects."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.counts import COUNT_M_S2
from arm.highpass import HighPass
from arm.model import Arm, Floats, Sensor
from fitter.data.raw import RawRun

RATE_HZ = 1000.0


@dataclass(frozen=True)
class Run:
    """A run as somebody measured it: the arm as its file has it, and its trials."""

    arm: Arm
    learn: list[RawRun]
    evaluate: list[RawRun]


@cache
def motion(name: str, seed: int, each: int = 2) -> tuple[Floats, Floats, Floats]:
    bench = Bench(rate_hz=RATE_HZ, trial_s=3.0, learning=each, evaluating=each)
    found = list(motions(load_arm(name), bench, seed))
    q, dq, ddq = (np.concatenate([getattr(one, part) for one in found]) for part in ("q", "dq", "ddq"))
    return q, dq, ddq


def measured(
    name: str,
    seed: int,
    changed: dict[int, dict[str, object]],
    touch: Callable[[Floats, Floats], Floats] | None,
    each: int = 2,
) -> Run:
    """Return readings of as many trials to learn from as to judge by.

    Sensors are changed in their fields, or ``touch(a, t)`` changes what they read.
    """
    arm = load_arm(name)
    q, dq, ddq = motion(name, seed, each)
    t = np.arange(len(q)) / RATE_HZ
    sensors: list[Sensor] = [
        replace(one, **changed.get(k, {}))
        for k, one in enumerate(arm.sensors)  # type: ignore[arg-type]
    ]
    rng = np.random.default_rng([seed, 8])
    a = specific_force(replace(arm, sensors=tuple(sensors)), q, dq, ddq) * np.array([one.scale for one in sensors])
    a = a.reshape(len(t), -1)
    HighPass(np.repeat([one.highpass_hz for one in sensors], 3), RATE_HZ).apply(a)
    a += np.ravel([one.bias_m_s2 for one in sensors]) + 0.02 * rng.standard_normal(a.shape[1])
    a += 0.02 * rng.standard_normal(a.shape)
    if touch is not None:
        a = touch(a, t)
    a = np.rint(a / COUNT_M_S2) * COUNT_M_S2
    n = len(t) // (2 * each)
    runs = [RawRun(f"{k}", RATE_HZ, t[k : k + n], a[k : k + n]) for k in range(0, len(t), n)]
    return Run(arm, runs[:each], runs[each:])


@pytest.fixture(scope="session")
def measured_run() -> Run:
    return measured("dd-arm-vertical", 31, {}, None)


@pytest.fixture(scope="session")
def measure() -> Callable[..., Run]:
    def of(name="dd-arm-vertical", seed=31, changed=None, touch=None, each=2) -> Run:
        return measured(name, seed, changed or {}, touch, each)

    return of
