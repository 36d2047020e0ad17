"""How well joints are tracked where the model is not the arm: play, flex, impacts, clocks, a base that shakes.

The built-in arm in a vertical plane rests for a second and swings for eleven, at 100 Hz, sensors with noise of
0.02 m/s^2. Each effect is there in three sizes. Compared are the live filter, one that takes the arm to be exact,
the smoother that does, and the most probable motion (`tracking.smoother.smoothed_frames.most_probable`).
"""

import argparse
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from rich.progress import track

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Floats
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, emit, run_command
from limbcal.errors import DataError
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.kalman.multiple_model_filter import MultipleModelFilter
from tracking.model.readings import Readings, ReadingsBuilder
from tracking.smoother.smoothed import Smoothed
from tracking.smoother.smoothed_frames import most_probable
from tracking.smoother.smoother import Smoother

RATE_HZ, SECONDS, REST_S, NOISE_M_S2 = 100.0, 12.0, 1.0, 0.02
#: Time constant of a base that shakes [s]; ringing of an impact: frequency [Hz], decay [s], strokes a second.
SHAKING_S, RINGING_HZ, DECAY_S, STROKES_1_S = 0.1, 15.0, 0.05, 1.0
#: Steps of a motion's differences in one of readings: over a whole step, speeds and accelerations contradict the
#: angles by as much as noise. A part of 0.007 m/s^2 is there all the time: an angle is off by 0.04 degrees.
FINER = 20
#: Standard deviations that a claim is held to.
SIGMAS = 3.0


class Motion(NamedTuple):
    """Times (n,), angles, velocities and accelerations, (n, 2) each."""

    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats


def swing(rng: np.random.Generator) -> Motion:
    """Return a motion from a rest on."""
    t = np.arange(0.0, SECONDS, 1.0 / RATE_HZ / FINER)
    rates, amplitudes = 2.0 * np.pi * rng.uniform(0.3, 1.0, 2), rng.uniform(0.4, 0.8, 2)
    since = np.maximum(t - REST_S, 0.0)[:, None]
    q = (1.0 - np.exp(-(since**3))) * amplitudes * np.sin(rates * since)
    dq = np.gradient(q, t, axis=0)
    return Motion(*(part[::FINER] for part in (t, q, dq, np.gradient(dq, t, axis=0))))


def felt(arm: Arm, motion: Motion) -> Floats:
    """Return what the sensors of an exact arm read, (n, 12)."""
    return specific_force(arm, motion.q, motion.dq, motion.ddq).reshape(len(motion.t), -1)


def with_last_turned(arm: Arm, motion: Motion, more: Floats) -> Floats:
    """Return readings if what the last sensor sits on is further by an angle (n,) than its link."""
    loose = np.column_stack([np.zeros_like(more), more])
    speed = np.gradient(loose, motion.t, axis=0)
    pushed = np.gradient(speed, motion.t, axis=0)
    readings = felt(arm, motion)
    turned = Motion(motion.t, motion.q + loose, motion.dq + speed, motion.ddq + pushed)
    readings[:, 9:] = felt(arm, turned)[:, 9:]
    return readings


def shaking_base(arm: Arm, motion: Motion, size: float, rng: np.random.Generator) -> Floats:
    """Return readings on a base that shakes, `size` being the rms along each axis [m/s^2]."""
    kept = np.exp(-1.0 / (RATE_HZ * SHAKING_S))
    b = size * rng.standard_normal((len(motion.t), 3))
    for k in range(1, len(b)):
        b[k] = kept * b[k - 1] + np.sqrt(1.0 - kept**2) * b[k]
    readings, frames = felt(arm, motion), axis_frames(arm, motion.q)
    for s, sensor in enumerate(arm.sensors):
        R = frames[:, sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
        readings[:, 3 * s : 3 * s + 3] += np.einsum("kij,ki->kj", R, b)
    return readings


def impacts(arm: Arm, motion: Motion, size: float, rng: np.random.Generator) -> Floats:
    """Return readings with impacts on the second link that ring, of standard deviation `size` [m/s^2]."""
    readings, t = felt(arm, motion), motion.t
    for begin in rng.uniform(REST_S, SECONDS, int(STROKES_1_S * SECONDS)):
        since = np.maximum(t - begin, 0.0)
        rings = (since > 0.0) * np.exp(-since / DECAY_S) * np.cos(2.0 * np.pi * RINGING_HZ * since)
        for s, sensor in enumerate(arm.sensors):
            if sensor.joint == 2:
                readings[:, 3 * s : 3 * s + 3] += size * rings[:, None] * rng.standard_normal(3)
    return readings


def late_sensor(arm: Arm, motion: Motion, size: float, _rng: np.random.Generator) -> Floats:
    """Return readings whose last sensor is late by `size` [s]."""
    readings = felt(arm, motion)
    for c in (9, 10, 11):
        readings[:, c] = np.interp(motion.t - size, motion.t, readings[:, c])
    return readings


def flex(arm: Arm, motion: Motion, size: float, _rng: np.random.Generator) -> Floats:
    """Return readings if the second link bends between its sensors, by `size` [rad] at 10 rad/s^2."""
    return with_last_turned(arm, motion, -0.1 * size * motion.ddq[:, 1])


def play(arm: Arm, motion: Motion, size: float, _rng: np.random.Generator) -> Floats:
    """Return readings if the last sensor is loose, with a play of `size` [rad]."""
    return with_last_turned(arm, motion, -0.5 * size * np.tanh(motion.dq[:, 1] / 0.1))


EFFECTS: dict[str, tuple[Callable[..., Floats], tuple[float, float, float], str]] = {
    "shaking base": (shaking_base, (0.1, 0.3, 1.0), "m/s^2"),
    "impacts": (impacts, (1.0, 3.0, 10.0), "m/s^2"),
    "late sensor": (late_sensor, (0.005, 0.01, 0.02), "s"),
    "flex": (flex, (0.005, 0.01, 0.02), "rad"),
    "play": (play, (0.005, 0.01, 0.02), "rad"),
}


def read(values: Floats, rng: np.random.Generator) -> Readings:
    """Return noisy readings as trackers take them."""
    builder = ReadingsBuilder(RATE_HZ, values.shape[1], RATE_HZ)
    builder.push(values + NOISE_M_S2 * rng.standard_normal(values.shape))
    return builder.done()


def score(q: Floats, variance: Floats, true: Floats) -> tuple[float, float]:
    """Return the mean error [deg] and the share of angles within three of the claimed standard deviations."""
    off = np.abs(q - true)
    return float(np.degrees(off.mean())), float(np.mean(off < SIGMAS * np.sqrt(variance)))


def of_smoother(found: Smoothed, true: Floats) -> tuple[float, float]:
    """Score a smoothed motion."""
    return score(found.states[:, :6:3], found.variance[:, ::3], true)


def of_exact_filter(arm: Arm, readings: Readings, true: Floats) -> tuple[float, float]:
    """Score the filter that takes the arm to be exact."""
    first = readings.values[: round(0.25 / readings.dt_s)]
    rest = (first, readings.noise, readings.factor, readings.dt_s)
    course = MultipleModelFilter(arm, true[0], True, *rest).follow(readings.values)
    return score(course.states[:, :6:3], course.variances, true)


def of_filter(arm: Arm, readings: Readings, true: Floats) -> tuple[float, float]:
    """Score the live filter."""
    tracker = KalmanTracker(arm, RATE_HZ, true[0], RATE_HZ)
    frames = tracker.push(0, readings.values)[0] + tracker.flush()[0]
    claims = [block.q_std for block in frames if block.q_std is not None]
    return score(np.vstack([block.q for block in frames]), np.square(np.vstack(claims)), true)


def act(options: argparse.Namespace) -> Document:
    """Track all cases and print the table."""
    arm, lines = load_arm("dd-arm-vertical"), []
    cases = [(name, k) for name in EFFECTS for k in range(3)]
    heads = ("filter, exact arm", "filter", "smoother, exact arm", "smoother")
    emit(f"{'':29}" + "".join(f"{head:>22}" for head in heads))
    for name, k in track(cases, "tracking", console=console, transient=True):
        make, sizes, unit = EFFECTS[name]
        rows = []
        for seed in range(options.seed, options.seed + options.seeds):
            rng = np.random.default_rng([seed, k])
            motion = swing(rng)
            readings = read(make(arm, motion, sizes[k], rng), rng)
            live = (of_exact_filter(arm, readings, motion.q), of_filter(arm, readings, motion.q))
            smoothed = [(float("nan"), 0.0), (float("nan"), 0.0)]
            if not options.filter_only:
                with suppress(DataError):
                    smoothed[0] = of_smoother(Smoother(arm, motion.q[0], True).smooth(readings), motion.q)
                smoothed[1] = of_smoother(most_probable(arm, readings, motion.q[0], True), motion.q)
            rows.append((*live, *smoothed))
        mean = np.mean(rows, axis=0)
        cells = [f"{error:8.3f} deg {100 * share:5.1f} %" for error, share in mean]
        emit(f"{name:14}{sizes[k]:8g} {unit:6}" + "".join(f"{cell:>22}" for cell in cells))
        lines.append(
            {"effect": name, "size": sizes[k], "unit": unit, "cases": np.reshape(rows, (len(rows), -1)).tolist()}
        )
    return {"lines": lines}


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(prog="python -m benchmarks.discrepancies", description=__doc__, parents=[common_options()])
    parser.add_argument("--seeds", type=int, default=3, metavar="N", help="motions of each case (3)")
    parser.add_argument("--filter-only", action="store_true", help="leave out the smoothers")
    parser.add_argument("--seed", type=int, default=0, help="the first of them (0)")
    parser.set_defaults(action=act)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
