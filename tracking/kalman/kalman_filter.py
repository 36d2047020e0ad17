"""The live tracker: an extended Kalman filter over the readings of all sensors at once.

It knows how rigidly mounted accelerometers must read together, so two sensors on a link show how it turns without
any integration, an elbow's acceleration shows in two frames, and where gravity shows the angles it holds them.
Gyroscopes, where the arm's sensors have them, show how links turn. It says how well it knows the angles, and when
its readings contradict the arm.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from arm.chain import chain_of
from arm.kinematics import tips_of
from arm.model import Arm, Floats
from limbcal.compiled import compiled
from limbcal.errors import ConfigError, DataError
from tracking.kalman.adaptive_filter import AdaptiveFilter
from tracking.model.decimation import Decimator
from tracking.model.frames import Block, Frames, Phase
from tracking.model.innovation_test import Consistency
from tracking.model.noise import StepWatch, noise_of
from tracking.model.sensor_paths import SensorPaths
from tracking.model.zero_velocity import window_frames

#: Longer gaps than this are not filled with predicted frames [s].
_LONGEST_BRIDGE_S = 1.0
#: Readings that a start needs at the least.
_FEWEST = 8


class KalmanTracker:
    """Joint motion by an extended Kalman filter at the frame rate.

    Parameters
    ----------
    arm : Arm
        Its sensors' scale, offset and corner are used; its lengths as far as ``length_std_m`` says. Its sensors'
        gyroscopes are read.
    rate_hz : float
    initial_q_rad : (n_joint,) or None
        Where the arm rests when tracking begins. With None it rests where gravity says, and at zero for angles
        that gravity does not show.
    frame_rate_hz : float
        Rounded to what divides the sampling rate, which it is where that is lower.

    Raises
    ------
    ConfigError
        If the arm has no sensor, or a number makes no sense.
    """

    method = "filter"

    def __init__(
        self, arm: Arm, rate_hz: float, initial_q_rad: Floats | None, frame_rate_hz: float = 1000.0
    ) -> None:
        q0 = np.zeros(arm.n_joint) if initial_q_rad is None else np.array(initial_q_rad, dtype=float)
        if q0.shape != (arm.n_joint,):
            raise ConfigError(f"initial_q_rad has shape {q0.shape}, expected one angle a joint ({arm.n_joint},)")
        if not frame_rate_hz > 0.0:
            raise ConfigError(f"frame_rate_hz is {frame_rate_hz:g}, expected more than 0")
        if not arm.sensors:
            raise ConfigError(f"arm {arm.name!r}: it has no [[sensor]], expected at least one")
        self._chain = chain_of(arm)
        self._arm, self._q0, self._given = arm, q0, initial_q_rad is not None
        self._rate_hz = rate_hz
        self._factor = max(1, round(rate_hz / frame_rate_hz))
        self.dt_s = self._factor / rate_hz
        self._n_channel, self._n_acceleration = arm.n_channel, 3 * len(arm.sensors)
        self._decimator = Decimator(self._factor, self._n_channel)
        self._paths = SensorPaths(arm, self.dt_s)
        self._waiting: list[Floats] = []  # readings before the filter has begun
        cell, n_cell = window_frames(self.dt_s)
        self._first_frames = cell * n_cell
        last = (self._first_frames - 1) * self._factor + self._factor // 2
        self._to_wait = last + 1 + self._decimator.delay_samples
        self._filter: AdaptiveFilter | None = None
        self._sample = 0
        self._anchor = _Anchor(0, 0)
        self._frame = 0
        self._trial = 0
        self._resting = True
        self._lost = False

    def push(self, t0_ns: int, readings: Floats) -> tuple[list[Frames], list[Phase]]:
        """Take in readings and give out the frames and phases that they complete.

        Parameters
        ----------
        t0_ns : int
            Time of the first reading.
        readings : (n, n_channel)
            Specific force in each sensor's own axes [m/s^2], columns s1x s1y s1z s2x ..., and after those of all
            sensors, where the arm's have gyroscopes, angular velocity in the same axes [rad/s], columns s1gx ...

        Returns
        -------
        frames : list of Frames
        phases : list of Phase

        Raises
        ------
        DataError
            If the number of columns is not three a sensor and three a gyroscope.
        """
        if readings.ndim != 2 or readings.shape[1] != self._n_channel:
            raise DataError(f"readings have shape {readings.shape}, expected (n, {self._n_channel})")
        self._anchor = _Anchor(t0_ns, self._sample)
        self._sample += len(readings)
        if self._filter is None:
            self._waiting.append(readings)
            if sum(map(len, self._waiting)) < self._to_wait:
                return [], []
            return self._begin()
        self._look(readings)
        return self._follow(self._decimator.push(readings))

    def push_all(self, blocks: Sequence[Block]) -> list[tuple[list[Frames], list[Phase]]]:
        """Do `push` with blocks of readings in a row; return what each of them completes.

        What it gives out is the same to the bit. All blocks are handed to each kernel together, unless they change
        what is known of the noise.

        Parameters
        ----------
        blocks : sequence of (t0_ns, readings)
        """
        if self._filter is None or len(blocks) < 2:
            return [self.push(*block) for block in blocks]
        whole = np.concatenate([readings for _, readings in blocks])
        if not self._watch.takes_quietly(whole):
            return [self.push(*block) for block in blocks]
        parts, so_far = [], 0
        for t0_ns, readings in blocks:
            anchor, so_far = _Anchor(t0_ns, self._sample + so_far), so_far + len(readings)
            parts.append(_Part(anchor, self._decimator.completes(so_far)))
        self._sample += so_far
        return self._follow_parts(self._decimator.push(whole), parts)

    def gap(self, n_samples: int) -> tuple[list[Frames], list[Phase]]:
        """Bridge samples that were lost: the motion goes on as predicted, ever less certain.

        Returns what the samples before the gap still complete, and the frames that bridge it; where it is longer
        than a second only that second of them.
        """
        frames, phases = self.flush()
        self._sample += n_samples
        missing = self._decimator.skip(n_samples)
        if self._filter is None or missing <= 0:
            self._frame += max(0, missing)
            self._lost = True
            return frames, phases
        bridged = min(missing, round(_LONGEST_BRIDGE_S / self.dt_s))
        more, begun = self._follow(np.full((bridged, self._n_channel), np.nan))
        self._frame += missing - bridged
        self._filter.skip(missing - bridged)
        self._lost = True
        return frames + more, phases + begun

    def flush(self) -> tuple[list[Frames], list[Phase]]:
        """Give out what waits for more samples, at the end of a recording."""
        frames: list[Frames] = []
        phases: list[Phase] = []
        if self._filter is None and sum(map(len, self._waiting)) >= _FEWEST:
            frames, phases = self._begin()
        more, ended = self._follow(self._decimator.flush())
        return frames + more, phases + ended

    def retime(self, rate_hz: float) -> None:
        """Go on with samples of a rate that differs so little that a frame stays as many samples.

        Parameters
        ----------
        rate_hz : float
        """
        self._rate_hz, self.dt_s = rate_hz, self._factor / rate_hz
        self._paths.retime(self.dt_s)
        if self._filter is not None:
            self._filter.retime(self.dt_s)

    def consistency(self) -> Consistency:
        """Return how well the readings since the last call fit the filter's own claims."""
        if self._filter is None:
            return Consistency(None, 0, 0, False)
        return self._filter.consistency()

    def _begin(self) -> tuple[list[Frames], list[Phase]]:
        """Learn the noise and start the filter, from the readings of the first quarter of a second."""
        readings = np.vstack(self._waiting)
        self._waiting = []
        n_gyro = self._n_channel - self._n_acceleration
        noise = noise_of(readings[: self._to_wait], self._rate_hz, n_gyro)
        self._watch = StepWatch(noise, n_gyro)
        self._felt_noise = noise.parts_of_mean(self._factor)
        frames = self._decimator.push(readings)
        first = frames[: self._first_frames] if len(frames) else readings.mean(axis=0)[None]
        self._filter = AdaptiveFilter(self._arm, self._q0, self._given, first, noise, self._factor, self.dt_s)
        self._look(readings)
        return self._follow(frames)

    def _look(self, readings: Floats) -> None:
        """Learn the converter's step, before anything that it explains is taken in."""
        if self._filter is not None and self._watch.look(readings):
            self._filter.learn(self._watch.noise)
            self._felt_noise = self._watch.noise.parts_of_mean(self._factor)

    def _follow(self, readings: Floats) -> tuple[list[Frames], list[Phase]]:
        return self._follow_parts(readings, [_Part(self._anchor, len(readings))])[0]

    def _follow_parts(self, readings: Floats, parts: Sequence["_Part"]) -> list[tuple[list[Frames], list[Phase]]]:
        """Take in readings, one a frame; return the motion in parts."""
        if not len(readings) or self._filter is None:
            return [([], []) for _ in parts]
        n, n_joint = len(readings), self._arm.n_joint
        course = self._filter.follow(readings)
        (q, dq, ddq, std), felt = np.empty((4, n, n_joint)), np.empty((n, self._n_acceleration))
        lost = _unpack(course.states, course.variances, readings, q, dq, ddq, std, felt)
        tip, points = tips_of(self._chain, q), self._paths.follow(q, felt, course.still)
        resting, begin = course.resting.tolist(), 0
        found: list[tuple[list[Frames], list[Phase]]] = []
        for self._anchor, end in parts:
            phases = self._phases(resting[begin:end])
            here, begin = slice(begin, end), end
            if here.start == end:
                found.append(([], []))
                continue
            frames = Frames(
                self._frame,
                self._time_ns(self._frame),
                self.dt_s,
                q[here],
                dq[here],
                ddq[here],
                tip[here],
                points[here],
                self._lost or (lost and bool(np.isnan(readings[here, 0]).any())),
                std[here],
                readings[here],
                self._felt_noise,
            )
            self._frame += frames.n
            self._lost = False
            found.append(([frames], phases))
        return found

    def _phases(self, resting: Sequence[bool]) -> list[Phase]:
        """Return where motions begin and end, by whether the arm rests in the next frames."""
        phases: list[Phase] = []
        for k, rests in enumerate(resting):
            if rests != self._resting:
                self._resting = rests
                self._trial += not rests
                phases.append(Phase("end" if rests else "begin", self._time_ns(self._frame + k), self._trial))
        return phases

    def _time_ns(self, frame: int) -> int:
        """Return the time of a frame, as the latest push has it: it is centred on its own sample."""
        sample = frame * self._factor + self._factor // 2
        return self._anchor.t_ns + round((sample - self._anchor.sample) / self._rate_hz * 1e9)


class _Anchor(NamedTuple):
    """A sample's time and number, by which frames have theirs."""

    t_ns: int
    sample: int


class _Part(NamedTuple):
    """Frames that are stamped by one anchor, up to number ``end`` of those at hand."""

    anchor: _Anchor
    end: int


@compiled
def _unpack(
    states: Floats,
    variances: Floats,
    readings: Floats,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    std: Floats,
    felt: Floats,
) -> bool:
    """Fill in what joints do, how well that is known, and the readings less their offsets; say if one was lost."""
    lost, n_joint = False, q.shape[1]
    for k in range(q.shape[0]):
        lost = lost or math.isnan(readings[k, 0])
        for j in range(n_joint):
            q[k, j], dq[k, j], ddq[k, j] = states[k, 3 * j], states[k, 3 * j + 1], states[k, 3 * j + 2]
            std[k, j] = math.sqrt(variances[k, j])
        for channel in range(felt.shape[1]):
            felt[k, channel] = readings[k, channel] - states[k, 3 * n_joint + channel]
    return lost
