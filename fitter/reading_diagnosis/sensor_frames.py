"""Raw readings cut into trials on the run's clock, and averaged to the rate at which they are judged.

A frame is the plain mean of the readings within it: white noise stays white, which a sharper low-pass would not
leave it, and what is faster than the frames is the same mean of the same motion for all sensors alike. The rest at
the start of a trial is recognised by the readings alone: it lasts until two sensors of a link, or the only one it
has, leave what they showed at first; a single sensor that wanders by itself is a suspect, not a motion.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats
from fitter.data.raw import RawRun
from limbcal.errors import DataError
from tracking.model.noise import noise_of

#: An arm's own motion is slower, and what is faster is left to its accelerations.
FRAME_RATE_HZ = 100.0
#: Frames a cell in which a rest is sought, and the number of first cells that it is compared with.
_CELL, _FIRST_CELLS = 5, 4
#: How many standard deviations a cell may be off in a rest.
_STRAYS = 5.0


@dataclass(frozen=True)
class TrialFrames:
    """One trial's frames.

    Attributes
    ----------
    raw : RawRun
        The readings at their full rate, this trial's alone.
    start_s : float
        Where it begins on the run's clock.
    continues : bool
        It goes on where the trial before it ended, so the arm is where it was.
    factor : int
        Readings a frame.
    values : (n, n_channel) [m/s^2]
        Not a number where readings were lost.
    std : (n_channel,) [m/s^2]
        White noise of a frame.
    resting : int
        Number of frames for which the arm rests at first.
    """

    raw: RawRun
    start_s: float
    continues: bool
    factor: int
    values: Floats
    std: Floats
    resting: int

    @property
    def dt_s(self) -> float:
        """From frame to frame."""
        return self.factor / self.raw.rate_hz

    @cached_property
    def t(self) -> Floats:
        """Times of the frames on the run's clock, (n,) [s]."""
        middle = 0.5 * (self.factor - 1) / self.raw.rate_hz
        times = self.start_s + middle + self.dt_s * np.arange(len(self.values))
        return np.asarray(times, dtype=np.float64)

    @cached_property
    def largest(self) -> Floats:
        """Largest magnitude within each frame, (n, n_channel) [m/s^2]: what clipping is recognised by."""
        return np.asarray(np.abs(in_frames(self.raw, self.raw.a, self.factor)).max(axis=1), dtype=np.float64)

    @cached_property
    def integral(self) -> Floats:
        """Integral of the readings since the trial began, (n, n_channel) [m/s]; lost ones count as nothing."""
        dt = 1.0 / self.raw.rate_hz
        whole = np.nan_to_num(in_frames(self.raw, self.raw.a, self.factor)).reshape(-1, self.values.shape[1])
        sums = np.cumsum(whole, axis=0) - 0.5 * whole
        mean: Floats = dt * sums.reshape(len(self.values), self.factor, -1).mean(axis=1)
        return mean

    @cached_property
    def weight(self) -> Floats:
        """One over the standard deviation of every frame, (n, n_channel); 0 where readings were lost.

        A reading that jumps between two samples does so at an unknown instant, so a frame may be off by
        half the jump's share of a frame. Jumps count that noise doesn't make.
        """
        noise = self.std * np.sqrt(self.factor)
        jump = in_frames(self.raw, _jumps(self.raw.a, noise), self.factor).max(axis=1)
        jump[1:] = np.maximum(jump[1:], jump[:-1])  # the sample after it may lie in the next frame
        spread: Floats = np.sqrt(self.std**2 + (0.5 * jump / self.factor) ** 2)
        weight: Floats = np.where(np.isnan(self.values), 0.0, 1.0 / spread)
        return weight

    def advanced(self, sensor: int, delay_s: float) -> Floats:
        """Return one sensor's frames, (n, 3), as they were had it not read ``delay_s`` late."""
        a = self.raw.a[:, 3 * sensor : 3 * sensor + 3]
        if delay_s == 0.0:
            return self.values[:, 3 * sensor : 3 * sensor + 3]
        at = np.clip(np.arange(len(a)) + delay_s * self.raw.rate_hz, 0.0, len(a) - 1.0)
        low = np.minimum(at.astype(np.intp), len(a) - 2)
        share = (at - low)[:, None]
        read = (1.0 - share) * a[low] + share * a[low + 1]
        return np.asarray(in_frames(self.raw, read, self.factor).mean(axis=1), dtype=np.float64)


def trials_of(arm: Arm, runs: Sequence[RawRun]) -> list[TrialFrames]:
    """Cut runs into trials and decimate them.

    Parameters
    ----------
    arm : Arm
    runs : sequence of RawRun
        In the order in which they were recorded; ``t`` may go on or start anew, then one follows the other.

    Raises
    ------
    DataError
        If readings don't fit the arm's sensors, or a trial is too short.
    """
    trials: list[TrialFrames] = []
    end = 0.0
    for run in runs:
        if run.a.shape[1] != 3 * len(arm.sensors):
            raise DataError(
                f"run {run.name!r} has {run.a.shape[1]} channels, expected {3 * len(arm.sensors)}: three a sensor"
            )
        own = run.t[0] >= end - 0.5 / run.rate_hz or not trials
        shift = 0.0 if own else end - run.t[0]
        parts = list(_parts(run))
        for part in parts:
            start = float(part.t[0] + shift)
            continues = bool(trials) and (own or part is not parts[0]) and start - end < 1.5 / run.rate_hz
            trials.append(_trial(arm, part, start, continues))
            end = float(part.t[-1] + shift + 1.0 / run.rate_hz)
    return trials


def _parts(run: RawRun) -> Iterator[RawRun]:
    """Yield a run's trials by its labels; without them it is one."""
    starts = [0]
    if run.trial is not None:
        starts += (np.flatnonzero(run.trial[1:] != run.trial[:-1]) + 1).tolist()
    for begin, end in zip(starts, [*starts[1:], len(run.t)], strict=True):
        gaps = tuple(replace(gap, row=gap.row - begin) for gap in run.gaps if begin < gap.row < end)
        yield replace(run, t=run.t[begin:end], a=run.a[begin:end], gaps=gaps, q=None, ref=None, trial=None)


def _trial(arm: Arm, raw: RawRun, start_s: float, continues: bool) -> TrialFrames:
    factor = max(1, round(raw.rate_hz / FRAME_RATE_HZ))
    values = in_frames(raw, raw.a, factor).mean(axis=1)
    if len(values) < 2 * _CELL * _FIRST_CELLS:
        raise DataError(f"run {raw.name!r} has {len(raw.t)} samples, expected a trial of a second at least")
    longest = max(raw.blocks(len(raw.t)), key=lambda block: len(block.a))
    noise = noise_of(longest.a, raw.rate_hz)
    std = np.sqrt(noise.of_mean(factor))
    return TrialFrames(raw, start_s, continues, factor, values, std, _rest(arm, values, std))


def _jumps(a: Floats, noise: Floats) -> Floats:
    """Return by how much readings (n, n_channel) jump before the next sample, as a size; 0 where they do not.

    What the changes before and after it share is motion. A change is a jump if more of it is its own, and noise is
    smaller.
    """
    change = np.diff(a, axis=0)
    shared = change.copy()  # the first and the last one have one neighbour only, and pass for motion
    shared[1:-1] = 0.5 * (change[:-2] + change[2:])
    own = np.abs(change - shared)
    is_jump = (np.abs(change) > np.sqrt(2.0) * _STRAYS * noise) & (own > np.abs(shared))
    return np.concatenate([np.where(is_jump, own, 0.0), np.zeros_like(a[:1])])


def in_frames(raw: RawRun, a: Floats, factor: int) -> Floats:
    """Return readings (n, n_column) by frames, (n_frame, factor, n_column); not a number where they were lost."""
    if raw.gaps:
        place = np.arange(len(a))
        for gap in raw.gaps:
            place[gap.row :] += gap.samples
        whole = np.full((int(place[-1]) + 1, a.shape[1]), np.nan)
        whole[place] = a
        a = whole
    n = len(a) // factor
    return a[: n * factor].reshape(n, factor, a.shape[1])


def _rest(arm: Arm, values: Floats, std: Floats) -> int:
    """Return how many frames the arm rests at first."""
    n_cell = len(values) // _CELL
    cells = values[: n_cell * _CELL].reshape(n_cell, _CELL, -1, 3).mean(axis=1)
    noise = (std / np.sqrt(_CELL)).reshape(-1, 3)
    each = _strays(cells, noise)  # of each sensor
    calm = np.ones(n_cell, dtype=np.bool_)
    for joint in {sensor.joint for sensor in arm.sensors}:
        there = [s for s, sensor in enumerate(arm.sensors) if sensor.joint == joint]
        calm &= np.sort(each[:, there], axis=1)[:, -2 if len(there) > 1 else -1] <= _STRAYS
    rest = _until_moved(calm)
    if rest > _FIRST_CELLS or any(joint.type != "revolute" for joint in arm.joints):
        return _CELL * rest
    # Nothing rests: the base may move. Then sensors of a link still read alike, as those of a turning one don't.
    alike = np.ones(n_cell, dtype=np.bool_)
    for joint in {sensor.joint for sensor in arm.sensors}:
        there = [s for s, sensor in enumerate(arm.sensors) if sensor.joint == joint]
        if len(there) < 2:
            return _CELL * rest
        turned = [rotation_from_rpy(*arm.sensors[s].rotation_rad) for s in there]
        on_link = np.stack([cells[:, s] @ R.T for s, R in zip(there, turned, strict=True)], axis=1)
        apart = on_link[:, 1:] - on_link[:, :1]
        twice = np.full((len(there) - 1, 3), np.sqrt(2.0) * noise[there].max())
        alike &= _strays(apart, twice).min(axis=1) <= _STRAYS
    return _CELL * _until_moved(alike)


def _strays(cells: Floats, noise: Floats) -> Floats:
    """Return how far cells (n_cell, m, 3) are from the first, (n_cell, m), in standard deviations."""
    first = cells[:_FIRST_CELLS].mean(axis=0)
    off: Floats = (np.abs(cells - first) / (noise * np.sqrt(1.0 + 1.0 / _FIRST_CELLS))).max(axis=2)
    return off


def _until_moved(calm: NDArray[np.bool_]) -> int:
    moved = np.flatnonzero(~calm)
    return int(moved[0] if len(moved) else len(calm))
