"""Which sensors tell which joint, and how they sit: what a tracker must know of an arm before it starts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats
from limbcal.errors import ConfigError

#: Two sensors this close together (seen along the joint's axis) give no angle.
_SHORTEST_BASELINE_M = 1e-3


@dataclass(frozen=True)
class Layout:
    """The sensors of an arm as arrays.

    Attributes
    ----------
    link : (n_sensor,) int
        The link that each sensor rides on, from 0.
    position : (n_sensor, 3)
    rotation : (n_sensor, 3, 3)
        From sensor axes to link axes.
    pair : (n_joint, 2) int
        For a joint that turns, the two sensors on its link that lie furthest apart across its axis; for one
        that slides, one sensor twice.
    """

    link: NDArray[np.int64]
    position: Floats
    rotation: Floats
    pair: NDArray[np.int64]


def layout_of(arm: Arm) -> Layout:
    """Find the sensors that give each joint's angle from positions.

    Raises
    ------
    ConfigError
        If a link has too few sensors, they lie along the joint's axis, or the arm is no serial chain.
    """
    position = np.array([sensor.position_m for sensor in arm.sensors], dtype=float).reshape(-1, 3)
    mistakes, pairs = [], []
    if not arm.is_serial:
        raise ConfigError(
            f"arm {arm.name!r} is a tree, or a joint hangs elsewhere than at the far end of the link before it; "
            "dead reckoning expects a serial chain, the filter and the smoother take either"
        )
    for i, joint in enumerate(arm.joints):
        on_link = [k for k, sensor in enumerate(arm.sensors) if sensor.joint == i + 1]
        if joint.type == "prismatic":
            if not on_link:
                mistakes.append(
                    f"arm {arm.name!r}: joint {i + 1} slides and has no sensor on its link, expected one"
                )
                continue
            pairs.append((on_link[0], on_link[0]))
            continue
        candidates = [(a, b) for a in on_link for b in on_link if a < b]
        spans = [float(np.linalg.norm(position[b, :2] - position[a, :2])) for a, b in candidates]
        if not spans or max(spans) < _SHORTEST_BASELINE_M:
            mistakes.append(
                f"arm {arm.name!r}: joint {i + 1} turns and has {len(on_link)} sensors on its link; "
                "expected two that lie apart across its axis"
            )
            continue
        pairs.append(candidates[int(np.argmax(spans))])
    if mistakes:
        raise ConfigError(mistakes)
    return Layout(
        np.array([sensor.joint - 1 for sensor in arm.sensors], dtype=np.int64),
        position,
        np.array([rotation_from_rpy(*sensor.rotation_rad) for sensor in arm.sensors]),
        np.array(pairs, dtype=np.int64),
    )
