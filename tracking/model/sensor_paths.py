"""Where each sensor has gone: its acceleration, turned into the base frame and integrated twice.

The angles say how a sensor is turned, nothing else of the arm is used: no length, no place of a sensor.
"""

import numpy as np
from numpy.typing import NDArray

from arm.chain import chain_of
from arm.kinematics import frames_of, rotation_from_rpy
from arm.model import Arm, Floats
from limbcal.compiled import compiled


class SensorPaths:
    """Dead reckoning of every sensor from rest to rest.

    Parameters
    ----------
    arm : Arm
    dt_s : float
    """

    def __init__(self, arm: Arm, dt_s: float) -> None:
        self._chain, self._dt_s = chain_of(arm), dt_s
        self._link = np.array([sensor.joint - 1 for sensor in arm.sensors])
        self._rotation = np.array([rotation_from_rpy(*sensor.rotation_rad) for sensor in arm.sensors])
        self._scale = np.array([sensor.scale for sensor in arm.sensors])
        n_sensor = len(arm.sensors)
        self._gravity = np.array(arm.gravity_m_s2, dtype=float)
        self._acceleration = np.zeros((n_sensor, 3))
        self._velocity = np.zeros((n_sensor, 3))
        self._moved = np.zeros((n_sensor, 3))

    def retime(self, dt_s: float) -> None:
        """Go on with another time from frame to frame."""
        self._dt_s = dt_s

    def follow(self, q: Floats, readings: Floats, still: NDArray[np.bool_]) -> Floats:
        """Return how far each sensor has moved, (n, n_sensor, 3), since the first frame.

        Parameters
        ----------
        q : (n, n_joint)
        readings : (n, 3 n_sensor) [m/s^2]
            Without their offsets. Where they are not a number a sensor goes on as fast as it went.
        still : (n,)
            The arm rests: velocities are zero.
        """
        moved = np.empty((len(q), len(self._link), 3))
        _integrate(
            frames_of(self._chain, q),
            self._link,
            self._rotation,
            readings,
            self._scale,
            self._gravity,
            still,
            self._dt_s,
            self._acceleration,
            self._velocity,
            self._moved,
            moved,
        )
        return moved


@compiled
def _integrate(
    frames: Floats,
    link: NDArray[np.int64],
    rotation: Floats,
    readings: Floats,
    scale: Floats,
    gravity: Floats,
    still: NDArray[np.bool_],
    dt: float,
    last: Floats,
    velocity: Floats,
    place: Floats,
    moved: Floats,
) -> None:
    """Integrate twice, taking the acceleration to change evenly in between; the state is carried on."""
    felt, turned = np.empty(3), np.empty(3)
    for k in range(moved.shape[0]):
        for s in range(link.size):
            for axis in range(3):
                felt[axis] = readings[k, 3 * s + axis] / scale[s, axis]
            for axis in range(3):  # sensor axes -> link axes
                turned[axis] = 0.0
                for of in range(3):
                    turned[axis] += rotation[s, axis, of] * felt[of]
            for c in range(3):  # link axes -> base frame
                now = gravity[c]
                for axis in range(3):
                    now += frames[k, link[s], c, axis] * turned[axis]
                if np.isnan(now):
                    now = 0.0
                if still[k]:
                    velocity[s, c] = 0.0
                else:
                    place[s, c] += dt * velocity[s, c] + dt * dt * (2.0 * last[s, c] + now) / 6.0
                    velocity[s, c] += dt * (last[s, c] + now) / 2.0
                last[s, c] = now
                moved[k, s, c] = place[s, c]
