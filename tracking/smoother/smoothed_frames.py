"""What a smoother gives out, in the form in which a tracker does."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import tip_position
from arm.model import Arm, Floats
from limbcal.errors import DataError
from tracking.model.frames import Frames, Phase
from tracking.model.initial_state import ROUGH, MountingPrior
from tracking.model.observation import MOUNTING, Observation
from tracking.model.readings import Readings
from tracking.model.sensor_paths import SensorPaths
from tracking.model.zero_velocity import window_frames
from tracking.smoother.discrepancy_smoother import DiscrepancySmoother
from tracking.smoother.smoothed import MountedElsewhere, Smoothed
from tracking.smoother.smoother import Smoother
from tracking.smoother.windows import windows_of


@dataclass(frozen=True)
class SmoothedMotion:
    """A whole recording's motion.

    Attributes
    ----------
    frames : Frames
    phases : list of Phase
        When the arm moved.
    windows : tuple of Smoothed
        What else the smoother says, window by window; of several without their motion and readings.
    lengths : tuple of int
        Frames of each window.
    """

    frames: Frames
    phases: list[Phase]
    windows: tuple[Smoothed, ...]
    lengths: tuple[int, ...]

    @property
    def smoothed(self) -> Smoothed:
        """What the smoother says of a recording of one window, and of the last of several."""
        return self.windows[-1]


class Departure(NamedTuple):
    """How an arm's sensors may differ from its file: in how they are mounted, and in their clocks."""

    mounting: MountingPrior | None
    clocks: bool


class Found(NamedTuple):
    """A motion, and by which departure from the arm's file the readings are explained: which one, or none."""

    departure: int
    smoothed: Smoothed


def most_probable(arm: Arm, readings: Readings, q: Floats, given: bool) -> Smoothed:
    """Return the most probable motion: of the arm as its file has it, if that explains the readings.

    Otherwise that of the arm with its sensors mounted as carefully as sensors are; then of one whose sensors'
    clocks differ; then of one whose sensors were mounted by eye, and of one with both, if that does: what departs
    less from the file comes first. Else that of an arm like it, with what the model lacks learnt as well.

    Parameters
    ----------
    arm, q, given
        As of `tracking.smoother.smoother.Smoother`.
    readings : Readings

    Raises
    ------
    DataError
        If no motion of the arm explains the readings at all.
    """
    return _found(arm, readings, q, given).smoothed


def _found(
    arm: Arm, readings: Readings, q: Floats, given: bool, before: Found | None = None, until: int | None = None
) -> Found:
    """Return the most probable motion of a window; what the window before departed by, this one does too."""
    exact: Smoothed | None = None
    careful = None if arm.sensor_covariance is not None else MountingPrior()
    rough = None if arm.sensor_covariance is not None else ROUGH
    all_kinds = [(None, False), (careful, False), (careful, True), (rough, False), (rough, True)]
    departures = [Departure(*kind) for kind in dict.fromkeys(all_kinds)]
    last = None if before is None else before.smoothed
    for k in range(0 if before is None else before.departure, len(departures)):
        mounting, clocks = departures[k]
        smoother = Smoother(arm, q, given, mounting, clocks)
        try:
            found = smoother.smooth(readings, previous=last, until=until, explaining=exact is not None)
        except DataError:
            break
        if found.is_exact:
            elsewhere = _elsewhere(smoother.observation, found.final) if mounting is ROUGH else None
            return Found(k, replace(found, mounted_elsewhere=elsewhere))
        exact = exact or found
    known = last if last is not None and last.discrepancy is not None else None
    robust = DiscrepancySmoother(arm, q, given)
    return Found(len(departures), robust.smooth(readings, exact, known, previous=last, until=until))


def _elsewhere(of: Observation, final: Floats) -> MountedElsewhere:
    """Return the largest departures from the arm's file among the mountings in a state."""
    mountings = np.array([final[first : first + MOUNTING] for first in of.mounting_column.tolist()])
    turn, place = (float(np.linalg.norm(mountings[:, part : part + 3], axis=1).max()) for part in (3, 6))
    return MountedElsewhere(place, turn)


def smooth_motion(arm: Arm, readings: Readings, initial_q_rad: Floats | None) -> SmoothedMotion:
    """Return the motion of a whole recording.

    Parameters
    ----------
    arm : Arm
    readings : Readings
    initial_q_rad : (n_joint,) or None
        Where the arm rests at first. With None it rests where gravity says, and at zero for angles that gravity
        does not show.
    """
    n, n_frame, n_channel = arm.n_joint, *readings.values.shape
    q0, given = (np.zeros(n), False) if initial_q_rad is None else (initial_q_rad, True)
    windows = windows_of(readings)
    motion, offset = np.empty((n_frame, 3 * n)), np.empty((n_frame, n_channel))
    std, still, resting = np.empty((n_frame, n)), *np.empty((2, n_frame), dtype=np.bool_)
    summaries, seen_after = list[Smoothed](), int(np.prod(window_frames(readings.dt_s)))
    before: Found | None = None
    for window in windows:
        until = None if window.ahead == window.end else window.end - window.begin
        before = _found(arm, window.of(readings), q0, given, before, until)
        found, own, kept = before.smoothed, slice(window.begin, window.end), slice(0, window.end - window.begin)
        motion[own] = found.states[kept, : 3 * n]
        offset[own] = found.states[kept, 3 * n : 3 * n + n_channel]
        std[own] = np.sqrt(found.variance[kept, ::3])
        still[own] = found.still[kept]
        # whether a motion goes on is seen in what was read last: at its beginning a window has read nothing
        judged = window.begin + (seen_after if window.begin else 0)
        resting[judged : window.ahead] = found.resting[judged - window.begin :]
        summaries.append(found if len(windows) == 1 else found.summary)
        before, q0, given = before._replace(smoothed=summaries[-1]), motion[window.end - 1, ::3].copy(), True
    q, dq, ddq = (motion[:, k::3].copy() for k in range(3))
    frames = Frames(
        0,
        round(1e9 * readings.t0_s),
        readings.dt_s,
        q,
        dq,
        ddq,
        tip_position(arm, q),
        SensorPaths(arm, readings.dt_s).follow(q, (readings.values - offset)[:, : 3 * len(arm.sensors)], still),
        bool(not readings.present.all()),
        std,
    )
    lengths = tuple(window.end - window.begin for window in windows)
    return SmoothedMotion(frames, _phases(resting, readings), tuple(summaries), lengths)


def _phases(rests: NDArray[np.bool_], readings: Readings) -> list[Phase]:
    resting = np.concatenate([[True], rests])
    trial, phases = 0, []
    for k in np.flatnonzero(np.diff(resting)):
        trial += bool(resting[k])
        t_ns = round(1e9 * (readings.t0_s + k * readings.dt_s))
        phases.append(Phase("begin" if resting[k] else "end", t_ns, trial))
    return phases
