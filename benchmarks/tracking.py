"""Trackers side by side: the same readings to each, its angles against the truth.

The paper's double integration, the live filter and the smoother follow the bench's learning motions on one clock,
without knowing where one motion ends and the next begins.
"""

import argparse
import os
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.progress import Progress

import fitter.single_thread  # noqa: F401 - the processes that it starts inherit it
from arm.arm_file import load_arm
from arm.bench import Bench, SensorErrors, Sensors, draw_sensor_errors, motions
from arm.counts import COUNT_M_S2
from arm.model import Arm, Floats
from benchmarks.cramer_rao import least_std
from benchmarks.tracking_report import Run, Track, draw, page, score, table
from fitter.parallel.spawned import in_order
from limbcal.arguments import Parser
from limbcal.command import console, emit, run_command, to_json
from tracking.dead_reckoning.integrator import Integrator
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.frames import Frames
from tracking.model.initial_state import MountingPrior
from tracking.model.readings import Readings, ReadingsBuilder
from tracking.smoother.self_calibration import calibrate_sensors
from tracking.smoother.smoothed_frames import smooth_motion

#: Samples that a live tracker is handed at once, 4 ms as by the daemon, and those that the decimation is.
_BLOCK, _PIECE = 128, 1 << 16
#: Samples a frame.
_FACTOR = 32
#: How much of a recording is tracked to have everything compiled [s].
_WARM_UP_S, _WARM_UP_SEED = 1.5, 1000


@dataclass(frozen=True)
class Case:
    """One bench: which arm, and how well its sensors measure."""

    arm: str = "dd-arm"
    noise: float = 1.0
    imperfect_mounting: bool = False


CASES = {
    "standard": Case(),
    "imperfect": Case(imperfect_mounting=True),
    "vertical": Case("dd-arm-vertical"),
    "spatial": Case("spatial-arm"),
    "noisy": Case(noise=5.0),
}


@dataclass(frozen=True)
class Recording:
    """What the sensors read, and the truth.

    ``counts`` (n_sample, n_channel), ``q`` (n_sample, n_joint), and where frames are due ``states``
    (n_frame, 3 n_joint): q, dq, ddq of joint 1, then of joint 2 and so on.
    """

    arm: Arm
    errors: SensorErrors
    rate_hz: float
    counts: NDArray[np.int16]
    q: Floats
    states: Floats

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return len(self.q) / self.rate_hz


def record(case: Case, seed: int, trials: int) -> Recording:
    """Return the bench's first motions as the virtual device measures them."""
    arm, rng = load_arm(case.arm), np.random.default_rng([seed, 2])
    errors = draw_sensor_errors(arm, rng, case.noise, case.imperfect_mounting)
    bench = Bench(learning=trials, evaluating=0)  # of any number the first are the same
    sensors = Sensors(arm, errors, bench.rate_hz, rng)
    counts, q, states = [], [], []
    for motion in motions(arm, bench, seed):
        counts.append(sensors.counts(motion))
        q.append(motion.q)
        due = slice(_FACTOR // 2, None, _FACTOR)
        state = np.stack([motion.q[due], motion.dq[due], motion.ddq[due]], axis=2)
        states.append(state.reshape(len(state), -1))
    return Recording(arm, errors, bench.rate_hz, np.concatenate(counts), np.concatenate(q), np.concatenate(states))


def samples(recording: Recording, at_once: int) -> Iterator[Floats]:
    """Yield accelerations (n, n_channel) [m/s^2], in blocks of equal length."""
    for first in range(0, len(recording.counts), at_once):
        yield np.multiply(recording.counts[first : first + at_once], COUNT_M_S2, dtype=np.float64)


def follow(tracker: Integrator | KalmanTracker, recording: Recording) -> Track:
    """Hand a recording to a live tracker as the daemon would."""
    begin = time.process_time()
    blocks: list[Frames] = []
    for k, block in enumerate(samples(recording, _BLOCK)):
        blocks += tracker.push(round(1e9 * k * _BLOCK / recording.rate_hz), block)[0]
    blocks += tracker.flush()[0]
    return _track(blocks, time.process_time() - begin)


def read(recording: Recording) -> Readings:
    """Decimate a recording."""
    builder = ReadingsBuilder(recording.rate_hz, recording.counts.shape[1])
    for piece in samples(recording, _PIECE):
        builder.push(piece)
    return builder.done()


def smooth(arm: Arm, recording: Recording, q0: Floats | None) -> Track:
    """Smooth a recording, taking the sensors to be as ``arm`` says."""
    begin = time.process_time()
    motion = smooth_motion(arm, read(recording), q0)
    track = _track([motion.frames], time.process_time() - begin)
    return replace(track, notes={"passes": motion.smoothed.passes, "converged": motion.smoothed.converged})


def _track(blocks: list[Frames], took: float) -> Track:
    t = np.concatenate([1e-9 * block.t0_ns + block.dt_s * np.arange(block.n) for block in blocks])
    claims = [block.q_std for block in blocks if block.q_std is not None]
    q_std = np.concatenate(claims) if claims else None
    return Track(t, np.concatenate([block.q for block in blocks]), q_std, took)


def tracks(recording: Recording, q0: Floats | None, mountings: bool) -> Iterator[tuple[str, Track]]:
    """Yield what each tracker makes of a recording, by its name."""
    arm, rate = recording.arm, recording.rate_hz
    at = np.zeros(arm.n_joint) if q0 is None else q0  # double integration must begin somewhere
    yield "integration, first rest", follow(Integrator(arm, rate, at, zero="first-rest"), recording)
    yield "integration, each rest", follow(Integrator(arm, rate, at, zero="each-rest"), recording)
    yield "filter", follow(KalmanTracker(arm, rate, q0), recording)
    yield "smoother", smooth(arm, recording, q0)
    if mountings:
        readings = read(recording)
        begin = time.process_time()
        found = calibrate_sensors(arm, [readings], q0, MountingPrior())
        took = time.process_time() - begin
        notes = {"calibration_cpu_s": took, "calibration_converged": found.converged}
        yield "filter, self-calibrated", follow(KalmanTracker(found.arm, rate, q0), recording)
        track = smooth(found.arm, recording, q0)
        yield "smoother, self-calibrated", replace(track, notes=track.notes | notes)


@cache
def _warm_up() -> None:
    """Compile, or load what was compiled: once a process."""
    whole = record(CASES["imperfect"], _WARM_UP_SEED, 1)
    n = round(_WARM_UP_S * whole.rate_hz)
    for _ in tracks(replace(whole, counts=whole.counts[:n], q=whole.q[:n]), whole.q[0], True):
        pass


def measure(name: str, seed: int, trials: int, initial: bool) -> Run:
    """Let every tracker follow one bench with one seed, and score them."""
    _warm_up()
    case = CASES[name]
    recording = record(case, seed, trials)
    q0 = recording.q[0] if initial else None
    clock = np.arange(len(recording.q)) / recording.rate_hz
    scores = {
        tracker: score(track, clock, recording.q)
        for tracker, track in tracks(recording, q0, case.imperfect_mounting)
    }
    arm, errors, dt_s = recording.arm, recording.errors, _FACTOR / recording.rate_hz
    std = least_std(arm, errors, recording.states, dt_s, _FACTOR, initial, case.imperfect_mounting)
    least = np.rad2deg(np.sqrt(2.0 / np.pi) * std.mean(axis=0))
    return Run(name, seed, recording.seconds, scores, least.tolist())


def _measured(job: tuple[str, int, int, bool]) -> Run:
    return measure(*job)


def compare(options: argparse.Namespace) -> None:
    """Run all benches, print the table and write what was asked for."""
    initial = not options.no_initial
    jobs = [(case, seed, options.trials, initial) for seed in options.seeds for case in options.benches]
    runs: list[Run] = []
    with Progress(console=console) as progress, closing(in_order(_measured, jobs, options.jobs)) as found:
        task = progress.add_task("tracking", total=len(jobs))
        for run in found:
            runs.append(run)
            progress.advance(task)
    runs.sort(key=lambda run: (options.benches.index(run.case), run.seed))
    emit(table(runs))
    if options.json is not None:
        options.json.write_text(to_json({"initial": initial, "runs": [run.document() for run in runs]}))
    if options.plot is not None:
        options.plot.write_bytes(draw([run for run in runs if run.seed == options.seeds[0]]))
    if options.out is not None:
        picture = None if options.plot is None else os.path.relpath(options.plot, options.out.parent)
        options.out.write_text(page(runs, initial, picture))


def _seeds(text: str) -> list[int]:
    """Read ``0-9`` or ``0,3,5-7``."""
    spans = [part.partition("-") for part in text.split(",")]
    try:
        found = [seed for first, _, last in spans for seed in range(int(first), int(last or first) + 1)]
    except ValueError:
        found = []
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is no list of seeds, expected one like 0-9 or 0,3,5-7")
    return found


def _cases(text: str) -> list[str]:
    names = text.split(",")
    for name in names:
        if name not in CASES:
            raise argparse.ArgumentTypeError(f"{name!r} is no bench, expected some of {', '.join(CASES)}")
    return names


def main(argv: list[str] | None = None) -> int:
    """Compare and show."""
    parser = Parser(prog="python -m benchmarks.tracking", description=__doc__)
    parser.add_argument("--seeds", type=_seeds, default=_seeds("0-9"), metavar="A-B")
    parser.add_argument("--benches", type=_cases, default=list(CASES), metavar="NAME,…")
    parser.add_argument("--trials", type=int, default=5, metavar="N", help="motions, 6.75 s each")
    parser.add_argument("--no-initial", action="store_true", help="do not tell where the arm rests at the start")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures, run by run")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the table with its explanation")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw the first seed's errors")
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    parser.set_defaults(action=compare)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
