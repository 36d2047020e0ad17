"""A run of raw accelerations, given to a tracker or to the smoother from its first sample to its last."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm
from fitter.data.raw import RawRun
from fitter.sensing.verdict import Verdict, merged, verdict_of
from tracking.model.frames import Frames, Phase
from tracking.smoother.smoothed_frames import smooth_motion
from tracking.tracker import Tracker, consistency_of

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Followed:
    """What came of a run, on its own clock.

    Attributes
    ----------
    frames : list of Frames
    phases : list of Phase
    verdict : Verdict
    """

    frames: list[Frames]
    phases: list[Phase]
    verdict: Verdict

    @property
    def t(self) -> Floats:
        """Time of each frame [s]."""
        stamps = [1e-9 * part.t0_ns + part.dt_s * np.arange(part.n) for part in self.frames]
        whole: Floats = np.concatenate(stamps)
        return whole

    @property
    def motions(self) -> list[tuple[float, float]]:
        """When the motions that ended began and ended [s]."""
        times = [1e-9 * phase.t_ns for phase in self.phases]
        return list(zip(times[0::2], times[1::2], strict=False))

    def column(self, name: str) -> Floats:
        """Return q, dq, ddq or points of all frames."""
        whole: Floats = np.concatenate([getattr(part, name) for part in self.frames])
        return whole

    @property
    def q_std(self) -> Floats | None:
        """How well the angles are known, (n, n_joint), by a tracker that says so."""
        known = [part.q_std for part in self.frames if part.q_std is not None]
        return np.concatenate(known) if known else None

    def predicted(self, run: RawRun) -> Bools:
        """Return which frames fell due among samples that were lost, (n,)."""
        number = np.concatenate([part.frame0 + np.arange(part.n) for part in self.frames])
        factor = round(self.frames[0].dt_s * run.rate_hz)
        sample = factor * number + factor // 2
        lost = np.array([gap.samples for gap in run.gaps])
        begin = np.array([gap.row for gap in run.gaps]) + np.cumsum(lost) - lost
        begun, ended = (np.searchsorted(edge, sample, side="right") for edge in (begin, begin + lost))
        inside: Bools = begun > ended
        return inside


def follow(run: RawRun, tracker: Tracker) -> Followed:
    """Give a run to a tracker, block by block."""
    frames: list[Frames] = []
    phases: list[Phase] = []

    def take(new: tuple[list[Frames], list[Phase]]) -> None:
        frames.extend(new[0])
        phases.extend(new[1])

    for block in run.blocks():
        if block.lost:
            take(tracker.gap(block.lost))
        take(tracker.push(block.t0_ns, np.hstack([block.a, block.w])))
    take(tracker.flush())
    return Followed(frames, phases, verdict_of(consistency_of(tracker), sum(part.n for part in frames)))


def smoothed(run: RawRun, arm: Arm, initial_q_rad: Floats | None, frame_rate_hz: float) -> Followed:
    """Give a run to the smoother as a whole."""
    found = smooth_motion(arm, run.readings(frame_rate_hz), initial_q_rad)
    start_ns = round(1e9 * run.t[0])
    frames = replace(found.frames, t0_ns=start_ns + found.frames.t0_ns)
    phases = [replace(phase, t_ns=start_ns + phase.t_ns) for phase in found.phases]
    said = [verdict_of(window, n) for window, n in zip(found.windows, found.lengths, strict=True)]
    return Followed([frames], phases, merged(said, found.lengths))
