"""What the virtual arm does and its sensors read: the bench's motions, and then rest for as long as it is on."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.bench import Bench, Sensors, densify, draw_sensor_errors, motions, rest_angles
from arm.model import Arm
from arm.simulation import Motion, simulate, tip_of
from daemon.virtual_device.bench_plan import BenchPlan, Stretch
from daemon.virtual_device.gyroscopes import Gyroscopes

#: The truth is kept at no more than this: the motion has nothing faster, and the file stays small.
TRUTH_HZ = 1000.0
#: Length of a stretch of the rest at the end [s].
_REST_S = 2.0


def truth_stride(rate_hz: float) -> int:
    """Return how many samples lie between two rows of the truth."""
    return max(1, round(rate_hz / TRUTH_HZ))


def stretches(plan: BenchPlan) -> Iterator[Stretch]:
    """Yield the trials, counted from 1, and then rest in stretches of 2 s, without end; the rest's trial is 0.

    The same plan gives the same samples.

    Raises
    ------
    ConfigError
        If the arm has no control law to drive it.
    """
    rng = np.random.default_rng([plan.seed, 2])
    errors = draw_sensor_errors(plan.arm, rng, plan.noise, plan.imperfect_mounting)
    sensors = Sensors(_coupled(plan), errors, plan.rate_hz, rng)
    gyroscopes = Gyroscopes(plan.arm, plan.noise, np.random.default_rng([plan.seed, 4]))
    bench = Bench(rate_hz=plan.rate_hz, learning=plan.trials, evaluating=0)  # of any number the first are the same
    motion: Motion | None = None
    sample = 0
    for trial, motion in enumerate(motions(plan.arm, bench, plan.seed), start=1):
        yield _stretch(plan, np.hstack([sensors.counts(motion), gyroscopes.counts(motion)]), motion, trial, sample)
        sample += len(motion.t)
    while True:
        motion = _rest(plan.arm, bench, motion)
        yield _stretch(plan, np.hstack([sensors.counts(motion), gyroscopes.counts(motion)]), motion, 0, sample)
        sample += len(motion.t)


def _coupled(plan: BenchPlan) -> Arm:
    if plan.highpass_hz is None:
        return plan.arm
    sensors = tuple(replace(sensor, highpass_hz=plan.highpass_hz) for sensor in plan.arm.sensors)
    return replace(plan.arm, sensors=sensors)


def _rest(arm: Arm, bench: Bench, before: Motion | None) -> Motion:
    """Return the arm held where the last target was, from the sample after ``before`` on."""
    if before is None:
        ref = dq = np.zeros(arm.n_joint)
        q = rest_angles(arm, ref)
    else:
        ref, q, dq = before.ref[-1], before.q[-1], before.dq[-1]
    step = 1.0 / bench.simulation_hz
    first = 0 if before is None else 1  # the simulation begins at the last sample, which was sent already
    n_sample = round(_REST_S * bench.rate_hz)
    n_step = int(np.ceil((n_sample + first) / bench.rate_hz / step)) + 2
    held = densify(simulate(arm, np.tile(ref, (n_step, 1)), step, q, dq), bench.rate_hz, n_sample + first)
    return replace(held, **{name: values[first:] for name, values in vars(held).items()})


def _stretch(plan: BenchPlan, counts: NDArray[np.int16], motion: Motion, trial: int, sample0: int) -> Stretch:
    stride = truth_stride(plan.rate_hz)
    rows = np.arange(-sample0 % stride, len(motion.q), stride)
    tip = tip_of(plan.arm, motion)[rows]
    truth = {"t": (sample0 + rows) / plan.rate_hz, "trial": np.full(len(rows), float(trial))}
    for name, values in (("q", motion.q), ("dq", motion.dq), ("ddq", motion.ddq), ("ref", motion.ref)):
        truth |= {f"{name}{j + 1}": values[rows, j] for j in range(values.shape[1])}
    truth |= {f"tip{axis}": tip[:, k] for k, axis in enumerate("xyz")}
    return Stretch(trial, counts, truth)
