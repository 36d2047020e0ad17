r"""Noise of the torque equation: the sensors' and the model's own.

.. math:: S(f) = P + Q (2 \pi f)^4 + D, \qquad P = diag(s_u^2), \quad Q = E[M diag(s_q^2) M^T]

``P`` is the torque's white noise and ``Q`` that of the angles, differentiated twice and multiplied by the masses.
``D`` is the floor: the variance of what the model lacks, one number a joint and trial, estimated by maximum
likelihood. Where the model is exact it vanishes.
"""

from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.torque.spectra import Complexes

#: Steps of Fisher scoring at the most, and the relative change after which it has settled.
_ROUNDS, _SETTLED = 12, 0.01
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

    def of_trial(self, f: Floats, draw: Complexes) -> "SensorNoise":
        """Return the noise of one trial, in which masses are others, by its own part of the draw.

        Parameters
        ----------
        f : (n,) [Hz]
        draw : (n, n_joint) complex
        """
        root = np.linalg.cholesky(self.covariance(f))
        white = np.linalg.solve(root, draw[:, :, None])[:, :, 0]
        scale = 0.5 * np.mean(np.abs(white) ** 2, axis=0)
        return replace(self, gain=self.gain * np.maximum(scale, _SINGULAR))

    def _root(self, f: Floats) -> Floats:
        squared = self.torque + self.acceleration * ((2.0 * np.pi * f) ** 4)[:, None, None]
        return np.asarray(np.linalg.cholesky(squared))


def with_floor(own: Floats, floor: Floats) -> Floats:
    """Return the covariance of noise with a floor, (n_frequency, n_joint, n_joint).

    Parameters
    ----------
    own : (n_frequency, n_joint, n_joint)
        Of the sensors.
    floor : (2, n_joint)
        Variance [N^2 m^2] of white missing torque, and that of missing torque with the sensors' own spectrum as a
        multiple of theirs.
    """
    at = np.arange(own.shape[1])
    covariance = own.copy()
    covariance[:, at, at] += floor[0] + floor[1] * own[:, at, at]
    return covariance


def floor_of(residual: Complexes, own: Floats, freedom: Floats, start: Floats) -> Floats:
    r"""Return the floor that makes a residual likeliest, by Fisher scoring.

    With :math:`z = L^{-1} r`, :math:`S = L L^T` and :math:`A_p = L^{-1} \partial S / \partial \theta_p L^{-T}` the
    score is :math:`\sum (z^H A_p z / 2 - tr A_p)` and its information :math:`\sum tr A_p A_q`.

    Parameters
    ----------
    residual : (n_frequency, n_joint) complex
        Coefficients of the torque that a model leaves.
    own : (n_frequency, n_joint, n_joint)
        Covariance of the sensors' noise.
    freedom : (n_frequency, n_joint)
        Share of the white coefficients that nuisance torques have left.
    start : (2, n_joint)
        Where the search begins.

    Returns
    -------
    (2, n_joint)
        See `with_floor`.
    """
    n_joint = own.shape[1]
    floor = np.maximum(start, 0.0).ravel()
    variance = np.diagonal(own, axis1=1, axis2=2)
    for _ in range(_ROUNDS):
        inverse = np.linalg.inv(np.linalg.cholesky(with_floor(own, floor.reshape(2, n_joint))))
        z = (inverse @ residual[:, :, None])[:, :, 0]
        # A_p is v v^T, v the joint's column of the inverse root, times its own variance for the second floor.
        columns = np.concatenate([inverse, inverse * np.sqrt(variance)[:, None, :]], axis=2)
        seen = 0.5 * np.sum(np.abs(np.einsum("fip,fi->fp", columns, z.conj())) ** 2, axis=0)
        expected = np.einsum("fip,fi->p", columns**2, freedom)
        products = np.einsum("fip,fi,fiq->fpq", columns, freedom, columns)
        information = np.sum(products**2, axis=0)
        score = seen - expected
        free = (floor > 0.0) | (score > 0.0)
        step = np.zeros_like(floor)
        if np.any(free):
            step[free] = np.linalg.lstsq(information[np.ix_(free, free)], score[free], rcond=1e-10)[0]
        new = np.maximum(floor + step, 0.0)
        settled = np.all(np.abs(new - floor) <= _SETTLED * np.maximum(new, floor))
        floor = new
        if settled:
            break
    return np.asarray(floor.reshape(2, n_joint), dtype=np.float64)


def sensor_noise(f: Floats, draw: Complexes) -> SensorNoise:
    """Return the sensors' noise by what a draw of it leaves.

    Parameters
    ----------
    f : (n,) [Hz]
        Of all motions' coefficients.
    draw : (n, n_joint) complex
        The draw's coefficients.
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
        # There is no less at frequency zero than the accelerations' noise makes of the lowest frequency.
        torque = np.maximum(above.mean(axis=0), np.diag(acceleration) * fourth.min())
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
