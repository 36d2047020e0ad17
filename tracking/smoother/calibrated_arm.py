"""An arm with sensors and lengths as the smoother found them."""

from dataclasses import replace

import numpy as np

from arm.kinematics import rotation_from_rpy, rpy_from_rotation
from arm.model import Arm, Floats, Gyroscope, Sensor, Vector3
from tracking.model.observation import ABSENT, MOUNTING, Observation
from tracking.smoother.smoothed import Smoothed


def with_lengths(arm: Arm, of: Observation, known: Smoothed, lengths: frozenset[tuple[int, str]]) -> Arm:
    """Return the arm with the lengths that were found."""
    joints = list(arm.joints)
    for i, joint in enumerate(arm.joints):
        columns = dict(zip(("a_m", "d_m"), of.length_column[i].tolist(), strict=True))
        found = {name: getattr(joint, name) + float(known.final[columns[name]]) for k, name in lengths if k == i}
        if found:
            std = max(float(np.sqrt(known.covariance[columns[name], columns[name]])) for name in found)
            joints[i] = replace(joint, **found, length_std_m=std)
    return replace(arm, joints=tuple(joints))


def with_sensors(arm: Arm, of: Observation, x: Floats) -> Arm:
    """Return the arm with its sensors as a state (n_state,) has them."""
    n = arm.n_joint
    sensors = []
    for s, sensor in enumerate(arm.sensors):
        first = of.mounting_column[s]
        scale, turn, place = x[first : first + MOUNTING].reshape(3, 3)
        rotation = rotation_from_rpy(*sensor.rotation_rad) @ _rotation(turn)
        corner = of.corner[s] + (x[of.corner_column[s]] if of.corner_column[s] != ABSENT else 0.0)
        settled = of.settled_column[s]
        offset = slice(settled, settled + 3) if settled != ABSENT else slice(3 * n + 3 * s, 3 * n + 3 * s + 3)
        sensors.append(
            Sensor(
                sensor.name,
                sensor.joint,
                _vector(np.add(sensor.position_m, place)),
                _vector(rpy_from_rotation(rotation)),
                _vector(np.add(sensor.scale, scale)),
                _vector(x[offset]),
                float(corner / (2.0 * np.pi)),
                _gyroscope(arm, of, s, x),
            )
        )
    return replace(arm, sensors=tuple(sensors))


def _gyroscope(arm: Arm, of: Observation, s: int, x: Floats) -> Gyroscope | None:
    """Return a sensor's gyroscope as it was found."""
    known = arm.sensors[s].gyroscope
    if known is None:
        return None
    triad = len(arm.sensors) + arm.gyroscopes.index(s)
    scale, bias = int(of.gyro_scale_column[triad]), 3 * arm.n_joint + 3 * triad
    return Gyroscope(_vector(np.add(known.scale, x[scale : scale + 3])), _vector(x[bias : bias + 3]))


def _rotation(turn: Floats) -> Floats:
    """Return ``Exp(turn)``, by Rodrigues' formula."""
    angle = float(np.linalg.norm(turn))
    K = np.cross(np.eye(3), turn)  # K v = turn x v
    if angle == 0.0:
        return np.eye(3)
    R: Floats = np.eye(3) + np.sin(angle) / angle * K + (1.0 - np.cos(angle)) / angle**2 * K @ K
    return R


def _vector(values: Floats) -> Vector3:
    x, y, z = (float(value) for value in values)
    return x, y, z
