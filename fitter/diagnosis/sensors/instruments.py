"""What the sensors are supposed to be: the arm file's, and what a hypothesis changes of it."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats, Sensor, Vector3


@dataclass(frozen=True)
class Instruments:
    """An arm with its sensors, and what an arm file has no field for.

    Attributes
    ----------
    arm : Arm
        Its sensors' corners are taken up in ``corner_hz``.
    corner_hz, delay_s, level : (n_sensor,)
        Of AC-coupled sensors, of late ones, and of those that clip [m/s^2]; 0, 0 and infinite for the others.
    drift : (n_sensor, 3) [m/s^3]
    base : (3, 2) [m/s^2]
        Acceleration of the base, x y z, cosine and sine.
    base_hz : float
    """

    arm: Arm
    corner_hz: Floats
    delay_s: Floats
    level: Floats
    drift: Floats
    base: Floats
    base_hz: float = 0.0

    def with_sensor(self, index: int, **changes: Vector3) -> "Instruments":
        """Return a copy with one sensor changed."""
        sensors = list(self.arm.sensors)
        sensors[index] = replace(sensors[index], **changes)  # type: ignore[arg-type]
        return replace(self, arm=replace(self.arm, sensors=tuple(sensors)))

    def with_entry(self, name: str, index: int, value: Floats | float) -> "Instruments":
        """Return a copy with one sensor's row of an array changed."""
        changed = getattr(self, name).copy()
        changed[index] = value
        return replace(self, **{name: changed})

    @property
    def bias(self) -> Floats:
        """What the sensors read too much, (3 n_sensor,) [m/s^2]."""
        return np.array([sensor.bias_m_s2 for sensor in self.arm.sensors], dtype=float).ravel()


def instruments_of(arm: Arm) -> Instruments:
    """Return the sensors as the arm file has them."""
    n = len(arm.sensors)
    corner = np.array([sensor.highpass_hz for sensor in arm.sensors], dtype=float)
    plain = tuple(replace(sensor, highpass_hz=0.0) for sensor in arm.sensors)
    return Instruments(
        replace(arm, sensors=plain), corner, np.zeros(n), np.full(n, np.inf), np.zeros((n, 3)), np.zeros((3, 2))
    )


def added(vector: Vector3, change: Floats) -> Vector3:
    """Return the sum of a field of a sensor and a change."""
    x, y, z = (float(a + b) for a, b in zip(vector, change, strict=True))
    return x, y, z


def turn_by_angles(sensor: Sensor, step: float = 1e-6) -> NDArray[np.float64]:
    """Return the small turn of a sensor about its own axes for a change of roll, pitch and yaw: (3, 3)."""
    R = rotation_from_rpy(*sensor.rotation_rad)
    turns = np.empty((3, 3))
    for k in range(3):
        change = step * np.eye(3)[k]
        dR = rotation_from_rpy(*added(sensor.rotation_rad, change)) - rotation_from_rpy(
            *added(sensor.rotation_rad, -change)
        )
        W = R.T @ dR / (2.0 * step)
        turns[:, k] = (W[2, 1] - W[1, 2]) / 2.0, (W[0, 2] - W[2, 0]) / 2.0, (W[1, 0] - W[0, 1]) / 2.0
    return turns
