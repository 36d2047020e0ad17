"""What a smoother gives out, in the form in which a tracker does."""

from dataclasses import dataclass

import numpy as np

from arm.kinematics import tip_position
from arm.model import Arm, Floats
from tracking.frames import Frames, Phase
from tracking.readings import Readings
from tracking.sensor_paths import SensorPaths
from tracking.smoother import Smoothed, Smoother


@dataclass(frozen=True)
class SmoothedMotion:
    """A whole recording's motion: the frames, when the arm moved, and what else the smoother says."""

    frames: Frames
    phases: list[Phase]
    smoothed: Smoothed


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
    found = Smoother(arm, q0, initial_q_rad is not None).smooth(readings)
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
        SensorPaths(arm, readings.dt_s).follow(q, readings.values - offset, found.still),
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
