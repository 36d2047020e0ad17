"""The bench as four accelerometers feel it: readings on one clock, followed to joint motion and a measured tip.

Nothing of the arm is handed on but how its joints turn, where its sensors sit on their links, how it is controlled
and where it rested at first; lengths and dynamics are for the fits to find.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from arm.bench import Bench, Sensors, draw_sensor_errors, motions, rest_angles, targets
from arm.counts import COUNT_M_S2
from arm.model import Arm, Control, Floats
from arm.simulation import Motion
from fitter.data.drift import dead_reckoned, without_drift
from fitter.data.measured_tip import measured_tip
from fitter.data.trial import Trial
from fitter.sensing.track import trials_of
from reproduction.bench_data import held_motions, true_arm, unknown_arm
from tracking.dead_reckoning.integrator import Integrator
from tracking.model.frames import Frames, Phase
from tracking.model.readings import ReadingsBuilder
from tracking.smoother.smoothed_frames import smooth_motion

Method = Literal["smooth", "integrate"]
#: Frames come at 1 kHz.
_FRAME_RATE_HZ = 1000
#: Samples that a live tracker is handed at once.
_BLOCK = 4096


@dataclass(frozen=True)
class SensedBench:
    """The same motions twice: as they were followed, and as they truly were at the same instants.

    Attributes
    ----------
    arm : Arm
        As it was known before, see `unknown_arm`.
    sensed, true : tuple of Trial
        The former with the measured tip; both with the controller's targets.
    recognised : int
        Motions that the tracker saw begin and end.
    """

    arm: Arm
    sensed: tuple[Trial, ...]
    true: tuple[Trial, ...]
    recognised: int


@lru_cache(maxsize=4)
def sensed_bench(
    control: Control,
    seed: int,
    learning: int = Bench.learning,
    evaluating: int = Bench.evaluating,
    method: Method = "smooth",
    rate_hz: float = Bench.rate_hz,
) -> SensedBench:
    """Return the standard bench's motions as its sensors show them, all on one clock.

    Parameters
    ----------
    control : Control
        Drives the paper's arm.
    seed : int
        Of targets, sensor errors and noise.
    learning, evaluating : int
    method : {"smooth", "integrate"}
        The smoother, or the paper's double integration, whose velocities are set to zero at each rest.
    rate_hz : float
        Of the sensors, a multiple of 2 kHz.
    """
    arm, bench = replace(true_arm(), control=control), Bench(rate_hz, learning=learning, evaluating=evaluating)
    q0 = rest_angles(arm, targets(bench, arm.n_joint, seed)[0])
    seen = _follow(arm, _sensors(arm, bench, seed), motions(arm, bench, seed), q0, method, rate_hz)
    return replace(seen, sensed=_with_roles(seen.sensed, learning), true=_with_roles(seen.true, learning))


@lru_cache(maxsize=2)
def sensed_one_by_one(
    control: Control, seed: int, learning: int = Bench.learning, rate_hz: float = Bench.rate_hz
) -> SensedBench:
    """Return the bench's first motions, each held at rest until it begins, each a recording of its own.

    See `sensed_bench` for the parameters and `reproduction.bench_data.held_motions` for the motions.
    """
    arm, bench = replace(true_arm(), control=control), Bench(rate_hz, learning=learning, evaluating=0)
    sensors = _sensors(arm, bench, seed)
    parts = [
        _follow(arm, sensors, [motion], motion.q[0], "smooth", rate_hz)
        for motion in held_motions(arm, bench, seed)
    ]
    return SensedBench(
        parts[0].arm,
        tuple(replace(part.sensed[0], name=f"held/{k}", role="learn") for k, part in enumerate(parts, 1)),
        tuple(part.true[0] for part in parts),
        len(parts),
    )


def _with_roles(trials: Sequence[Trial], learning: int) -> tuple[Trial, ...]:
    return tuple(replace(trial, role="learn" if k < learning else "evaluate") for k, trial in enumerate(trials))


def _sensors(arm: Arm, bench: Bench, seed: int) -> Sensors:
    rng = np.random.default_rng([seed, 2])
    return Sensors(arm, draw_sensor_errors(arm, rng), bench.rate_hz, rng)


def _follow(
    arm: Arm, sensors: Sensors, moved: Iterable[Motion], q0: Floats, method: Method, rate_hz: float
) -> SensedBench:
    """Let the sensors read motions that follow each other on one clock, and a tracker follow the readings."""
    known, factor = unknown_arm(arm), round(rate_hz / _FRAME_RATE_HZ)
    builder = ReadingsBuilder(rate_hz, 3 * len(arm.sensors), _FRAME_RATE_HZ)
    tracker = Integrator(known, rate_hz, q0, zero="each-rest")
    blocks: list[Frames] = []
    phases: list[Phase] = []
    true: list[Trial] = []
    pushed = 0
    for number, motion in enumerate(moved, 1):
        readings = np.multiply(sensors.counts(motion), COUNT_M_S2, dtype=np.float64)
        if method == "smooth":
            builder.push(readings)
        else:
            for first in range(0, len(readings), _BLOCK):
                new = tracker.push(round(1e9 * (pushed + first) / rate_hz), readings[first : first + _BLOCK])
                blocks += new[0]
                phases += new[1]
        pushed += len(readings)
        due = slice(factor // 2, None, factor)
        columns = {name: getattr(motion, name)[due] for name in ("q", "dq", "ddq", "tau", "ref")}
        t = np.arange(len(columns["q"])) / _FRAME_RATE_HZ
        true.append(Trial(f"bench/{number}", t, 1.0 / _FRAME_RATE_HZ, **columns))
    if method == "smooth":
        found = smooth_motion(known, builder.done(), q0)
        blocks, phases = [found.frames], found.phases
    else:
        last = tracker.flush()
        blocks, phases = blocks + last[0], phases + last[1]
    recognised = len(np.unique(trials_of(_times(blocks), phases)))
    return SensedBench(known, _trials(known, method, blocks, phases, true), tuple(true), recognised)


def _trials(
    arm: Arm, method: Method, blocks: Sequence[Frames], phases: Sequence[Phase], true: Sequence[Trial]
) -> tuple[Trial, ...]:
    """Part the frames at the controller's own clock, and take the drift of dead reckoning out between rests."""
    t = _times(blocks)
    columns = {
        name: np.concatenate([getattr(part, name) for part in blocks]) for name in ("q", "dq", "ddq", "points")
    }
    ends = [1e-9 * phase.t_ns for phase in phases]
    spans = list(zip(ends[0::2], ends[1::2], strict=False))
    columns = without_drift(t, columns, spans, dead_reckoned(method))
    tip = measured_tip(arm, columns["q"], columns["points"])
    dt_s, trials = blocks[0].dt_s, []
    begin = 0.5 * dt_s  # frames of the truth are due in the middle of their samples
    for motion in true:
        instants = begin + motion.t
        q, dq, ddq = (_at(instants, t, columns[name]) for name in ("q", "dq", "ddq"))
        trials.append(replace(motion, q=q, dq=dq, ddq=ddq, tau=None, tip=_at(instants, t, tip)))
        begin += len(motion.t) * dt_s
    return tuple(trials)


def _at(instants: Floats, t: Floats, values: Floats) -> Floats:
    """Return values at some instants; frames of a tracker that lags lie between those of the truth."""
    return np.column_stack([np.interp(instants, t, column) for column in values.T])


def _times(blocks: Sequence[Frames]) -> Floats:
    return np.concatenate([1e-9 * part.t0_ns + part.dt_s * np.arange(part.n) for part in blocks])
