"""The measured tip r*, which knows nothing of the arm's lengths."""

from dataclasses import replace

import numpy as np

from arm.kinematics import axis_frames
from arm.model import Arm, Floats
from fitter.data.trial import Trial
from limbcal.errors import ConfigError, DataError


def measured_tip(arm: Arm, q: Floats, points: Floats) -> Floats:
    """Return how far the tip has moved: its sensor's dead reckoning plus the known offset, turned with its link.

    Parameters
    ----------
    arm : Arm
        Its tip sensor and the directions of its joint axes are used; no length between joints is.
    q : (n_sample, n_joint) [rad or m]
    points : (n_sample, n_sensor, 3) [m]
        How far each sensor has moved since tracking began.

    Returns
    -------
    (n_sample, 3) [m]
        Up to a constant: only displacements mean something.

    Raises
    ------
    ConfigError
        If the arm has no tip.
    DataError
        If the points are not those of the arm's sensors.
    """
    if arm.tip is None:
        raise ConfigError(f"arm {arm.name!r} has no [tip], expected the sensor that measures it")
    if points.shape[1:] != (len(arm.sensors), 3):
        raise DataError(
            f"points have shape {points.shape}, expected {len(arm.sensors)} sensors as arm {arm.name!r} has"
        )
    k = arm.sensor_index(arm.tip.sensor)
    turned = axis_frames(arm, q)[:, arm.sensors[k].joint - 1, :3, :3] @ np.array(arm.tip.offset_m)
    tip: Floats = points[:, k] + turned
    return tip


def with_measured_tip(arm: Arm, trial: Trial) -> Trial:
    """Return a trial whose tip is what its points measure; one without points is returned as it is."""
    if trial.points is None or trial.tip is not None:
        return trial
    return replace(trial, tip=measured_tip(arm, trial.q, trial.points))
