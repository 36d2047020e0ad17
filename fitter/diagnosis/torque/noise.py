r"""Noise of the torque equation: the sensors' and the model's own.

.. math:: S(f) = P + Q (2 \pi f)^4 + D, \qquad P = diag(s_u^2), \quad Q = E[M diag(s_q^2) M^T]

``P`` is the torque's white noise and ``Q`` that of the angles, differentiated twice and multiplied by the masses.
``D`` is the floor: the variance of what the model lacks, one number a joint and trial, estimated by maximum
likelihood. Where the model is exact it vanishes.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats

#: Fisher scoring for the floor converges geometrically; by then it has moved less than a percent a step.
_ROUNDS = 30
#: Bins in which a draw's power says how much each coefficient counts.
_BINS = 8
#: Along no direction of the joints' torques is there less noise than this part of the most: that is rounding.
_SINGULAR = 1e-6


@dataclass(frozen=True)
class SensorNoise:
    """The sensors' part of the noise's covariance a sample.

    Attributes
    ----------
    torque, acceleration : (n_joint, n_joint)
        Factors of 1 and of ``(2 pi f)^4``.
    f : (n_bin,) [Hz]
    gain : (n_bin, n_joint)
        By which the white coefficients' variance departs from that: a law's torque has other powers of f in it.
    """

    torque: Floats
    acceleration: Floats
    f: Floats
    gain: Floats

    def covariance(self, f: Floats) -> Floats:
        """Return the covariance at frequencies (n,) [Hz], (n, n_joint, n_joint)."""
        root = self._root(f)
        gain = np.stack([np.interp(f, self.f, one) for one in self.gain.T], axis=1)
        return np.asarray((root * gain[:, None, :]) @ root.mT)

    def _root(self, f: Floats) -> Floats:
        squared = self.torque + self.acceleration * ((2.0 * np.pi * f) ** 4)[:, None, None]
        return np.asarray(np.linalg.cholesky(squared))


def floor_of(power: Floats, sensors: Floats, freedom: Floats, start: Floats) -> Floats:
    """Return the floor that makes a residual likeliest, joint by joint.

    Parameters
    ----------
    power : (n_frequency, n_joint)
        Mean square of real and imaginary part of the residual's coefficients.
    sensors : (n_frequency, n_joint)
        Variance that sensors explain.
    freedom : (n_frequency, n_joint)
        Share of the coefficients that nuisance torques have left.
    start : (n_joint,)
        Where the search begins.

    Returns
    -------
    (n_joint,)
        Variances [N^2 m^2], zero where sensors explain all.
    """
    floor = np.maximum(start, 0.0)
    excess = power - freedom * sensors
    for _ in range(_ROUNDS):
        information = 1.0 / (sensors + floor) ** 2  # of the variance, by one coefficient
        floor = np.maximum(np.sum(information * excess, axis=0) / np.sum(information * freedom, axis=0), 0.0)
    return np.asarray(floor, dtype=np.float64)


def sensor_noise(f: Floats, draw: "np.ndarray", least: Floats) -> SensorNoise:
    """Return the sensors' noise by what a draw of it leaves.

    Parameters
    ----------
    f : (n,) [Hz]
        Of all motions' coefficients.
    draw : (n, n_joint) complex
        The draw's coefficients.
    least : (n_joint,)
        Least variance of the torque's noise: that of rounding.
    """
    power = 0.5 * np.abs(draw) ** 2
    fourth = (2.0 * np.pi * f) ** 4
    upper, lower = f >= 0.5 * f.max(), f <= 0.25 * f.max()
    torque = np.zeros(draw.shape[1])
    for _ in range(3):
        scaled = draw[upper] / np.sqrt(fourth[upper])[:, None]
        acceleration = 0.5 * np.real(scaled.T @ scaled.conj()) / np.count_nonzero(upper)
        acceleration -= np.diag(torque) * np.mean(1.0 / fourth[upper])
        acceleration = _possible(acceleration)
        above = power[lower] - fourth[lower, None] * np.diag(acceleration)
        torque = np.maximum(above.mean(axis=0), least)
    edges = f.max() * np.linspace(0.0, 1.0, _BINS + 1) ** 1.5
    at = np.clip(np.searchsorted(edges, f) - 1, 0, _BINS - 1)
    plain = SensorNoise(np.diag(torque), acceleration, np.zeros(1), np.ones((1, draw.shape[1])))
    white = np.linalg.solve(plain._root(f), draw[:, :, None])[:, :, 0]  # noqa: SLF001 - of its own class
    gain = np.stack([0.5 * np.mean(np.abs(white[at == k]) ** 2, axis=0) for k in range(_BINS)])
    return SensorNoise(np.diag(torque), acceleration, 0.5 * (edges[1:] + edges[:-1]), np.maximum(gain, _SINGULAR))


def _possible(matrix: Floats) -> Floats:
    """Return the nearest covariance to a matrix."""
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    values, axes = np.linalg.eigh(matrix / np.outer(size, size))
    return np.asarray((axes * np.maximum(values, _SINGULAR)) @ axes.T * np.outer(size, size), dtype=np.float64)
