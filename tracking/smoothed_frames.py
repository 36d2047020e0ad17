"""What a smoother gives out, in the form in which a tracker does."""

from dataclasses import dataclass, replace

import numpy as np

from arm.kinematics import tip_position
from arm.model import Arm, Floats
from limbcal.errors import DataError
from tracking.discrepancy_smoother import DiscrepancySmoother
from tracking.frames import Frames, Phase
from tracking.observation import MOUNTING, Observation
from tracking.readings import Readings
from tracking.sensor_paths import SensorPaths
from tracking.smoothed import MountedElsewhere, Smoothed
from tracking.smoother import Smoother
from tracking.start import ROUGH, MountingPrior


@dataclass(frozen=True)
class SmoothedMotion:
    """A whole recording's motion: the frames, when the arm moved, and what else the smoother says."""

    frames: Frames
    phases: list[Phase]
    smoothed: Smoothed


def most_probable(arm: Arm, readings: Readings, q: Floats, given: bool) -> Smoothed:
    """Return the most probable motion: of the arm as its file has it, if that explains the readings.

    Otherwise that of the arm with its sensors mounted as carefully as sensors are; then of one whose sensors'
    clocks differ; then of one whose sensors were mounted by eye, and of one with both, if that does: what departs
    less from the file comes first. Else that of an arm like it, with what the model lacks learnt as well.

    Parameters
    ----------
    arm, q, given
        As of `tracking.smoother.Smoother`.
    readings : Readings

    Raises
    ------
    DataError
        If no motion of the arm explains the readings at all.
    """
    exact: Smoothed | None = None
    careful = None if arm.sensor_covariance is not None else MountingPrior()
    rough = None if arm.sensor_covariance is not None else ROUGH
    departures = [(None, False), (careful, False), (careful, True), (rough, False), (rough, True)]
    for mounting, clocks in dict.fromkeys(departures):
        smoother = Smoother(arm, q, given, mounting, clocks)
        try:
            found = smoother.smooth(readings)
        except DataError:
            break
        if found.is_exact:
            elsewhere = _elsewhere(smoother.observation, found.final) if mounting is ROUGH else None
            return replace(found, mounted_elsewhere=elsewhere)
        exact = exact or found
    return DiscrepancySmoother(arm, q, given).smooth(readings, exact)


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
    n = arm.n_joint
    q0 = np.zeros(n) if initial_q_rad is None else initial_q_rad
    found = most_probable(arm, readings, q0, initial_q_rad is not None)
    q, dq, ddq = (found.states[:, k : 3 * n : 3].copy() for k in range(3))
    offset = found.states[:, 3 * n : 3 * n + readings.values.shape[1]]
    frames = Frames(
        0,
        round(1e9 * readings.t0_s),
        readings.dt_s,
        q,
        dq,
        ddq,
        tip_position(arm, q),
        SensorPaths(arm, readings.dt_s).follow(
            q, (readings.values - offset)[:, : 3 * len(arm.sensors)], found.still
        ),
        bool(not readings.present.all()),
        np.sqrt(found.variance[:, ::3]),
    )
    return SmoothedMotion(frames, _phases(found, readings), found)


def _phases(found: Smoothed, readings: Readings) -> list[Phase]:
    resting = np.concatenate([[True], found.resting])
    trial, phases = 0, []
    for k in np.flatnonzero(np.diff(resting)):
        trial += bool(resting[k])
        t_ns = round(1e9 * (readings.t0_s + k * readings.dt_s))
        phases.append(Phase("begin" if resting[k] else "end", t_ns, trial))
    return phases
