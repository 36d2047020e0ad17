"""The virtual arm's gyroscopes and their converters."""

import numpy as np
from numpy.typing import NDArray

from arm.counts import COUNT_RAD_S
from arm.gyroscope import angular_velocity
from arm.model import Arm
from arm.simulation import Motion

#: White noise of a sample and offset of an axis, rms [rad/s]: half a degree a second each, a chip's at some kHz.
NOISE_RAD_S, BIAS_RAD_S = 0.01, 0.01


class Gyroscopes:
    """What the gyroscopes of an arm's sensors count, over motions that follow each other on one clock.

    Parameters
    ----------
    arm : Arm
        Scale and bias of its gyroscopes count as well.
    noise : float
        Factor on noise and offset; 0 for gyroscopes without either.
    rng : Generator
        Draws both.
    """

    def __init__(self, arm: Arm, noise: float, rng: np.random.Generator) -> None:
        found = [sensor.gyroscope for sensor in arm.sensors if sensor.gyroscope is not None]
        self._arm, self._noise, self._rng = arm, noise, rng
        self._scale = np.ravel([gyroscope.scale for gyroscope in found])
        self._bias = np.ravel([gyroscope.bias_rad_s for gyroscope in found])
        self._bias = self._bias + noise * BIAS_RAD_S * rng.standard_normal(self._bias.shape)

    def counts(self, motion: Motion) -> NDArray[np.int16]:
        """Return what the converters give out: 16 bits over +-2000 degrees a second, clipped.

        Returns
        -------
        (n_sample, 3 * n_gyroscope)
            Multiply by `COUNT_RAD_S` for rad/s.
        """
        w = angular_velocity(self._arm, *motion.of_links[:2]).reshape(len(motion.q), -1)
        w = self._scale * w + self._bias + self._noise * NOISE_RAD_S * self._rng.standard_normal(w.shape)
        counts: NDArray[np.int16] = np.clip(np.rint(w / COUNT_RAD_S), -32768, 32767).astype(np.int16)
        return counts
