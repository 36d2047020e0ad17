r"""Weights of one motion's rows: white noise, and no torque of which nothing is known.

With ``S = L L^T`` the rows ``L^-1 X`` have white noise of variance one. Torques of unknown size (what holds a
joint at rest, what a filter makes of the ends) add a covariance ``U U^T``. With the singular values s of the
whitened ``U`` rows count ``1 / sqrt(1 + s^2)`` times along each of its axes; those of any size are eliminated.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from arm.model import Floats
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.torque.spectra import Complexes, Spectra
from fitter.diagnosis.unknown_torque import end_shapes, holding_shapes, jump_shapes, rest_shapes

#: Directions whose part of the largest is below this are rounding.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class Unknown:
    """Coefficients of torques of which nothing is known, and of those whose size is known roughly.

    Attributes
    ----------
    anyhow, roughly : (n_frequency, n_joint, k) complex
    """

    anyhow: Complexes
    roughly: Complexes


def unknown_torques(motion: Motion, spectra: Spectra, holding: Floats) -> Unknown:
    """Return what is not known of the torques in a motion.

    Parameters
    ----------
    motion : Motion
    spectra : Spectra
    holding : (n_joint,) [N m or N]
        Standard deviation of what may hold a joint at rest; infinite where nothing tells.
    """
    n, n_joint = motion.q.shape
    ends = end_shapes(n, motion.dt_s)
    anyhow = [_at(j, ends, n_joint) for j in range(n_joint)]
    roughly = [jump_shapes(motion.jumps, n, n_joint)]
    for j, size in enumerate(holding):
        shapes = holding_shapes(motion.stuck[:, j], motion.dt_s)
        if np.isfinite(size):
            roughly.append(_at(j, size * shapes, n_joint))
            shapes = rest_shapes(motion.stuck[:, j], motion.dt_s)
        anyhow.append(_at(j, shapes, n_joint))
    return Unknown(*(spectra.of(np.concatenate(part, axis=2)) for part in (anyhow, roughly)))


class Weights:
    """Weights of one motion's rows.

    Parameters
    ----------
    covariance : (n_frequency, n_joint, n_joint)
        Of the noise of one coefficient's real or imaginary part.
    unknown : Unknown
    """

    def __init__(self, covariance: Floats, unknown: Unknown) -> None:
        root = np.linalg.cholesky(covariance)
        self._inverse = np.linalg.inv(root)
        anyhow, roughly = self._white(unknown.anyhow), self._white(unknown.roughly)
        held = _orthonormal(anyhow)
        U, size = _singular(roughly - held @ (held.T @ roughly))
        self._axes = np.asfortranarray(np.hstack([held, U]))
        self._lost = np.concatenate([np.ones(held.shape[1]), 1.0 - 1.0 / np.sqrt(1.0 + size**2)])
        n_frequency, self.n_joint = covariance.shape[:2]
        lost = (self._axes**2) @ (1.0 - (1.0 - self._lost) ** 2)
        #: Share of each coefficient's rows that unknown torques have left, (n_frequency, n_joint).
        self.freedom = np.maximum(1.0 - lost.reshape(n_frequency, self.n_joint, 2).mean(axis=2), _ROUNDING)
        #: How many independent numbers the rows are.
        self.n_effective = float(2.0 * self.freedom.sum())
        #: Logarithm of each white coefficient's variance, (n_frequency, n_joint).
        self.log_variance = log_variances(covariance)

    def rows(self, coefficients: Complexes) -> Floats:
        """Return coefficients (n_frequency, n_joint, k) as white real rows, (2 n_frequency n_joint, k)."""
        white = self._white(coefficients)
        along = self._axes.T @ white
        return np.asarray(white - self._axes @ (self._lost[:, None] * along))

    def coefficients(self, rows: Floats) -> Complexes:
        """Return white rows (2 n_frequency n_joint, k) as white coefficients, (n_frequency, n_joint, k)."""
        parts = rows.reshape(len(self._inverse), self.n_joint, 2, -1)
        return np.asarray(parts[:, :, 0] + 1j * parts[:, :, 1])

    def torque(self, rows: Floats) -> Complexes:
        """Return white rows (…, k) as coefficients of torque, (n_frequency, n_joint, k) complex [N m]."""
        return np.asarray(np.linalg.solve(self._inverse, self.coefficients(rows)))

    def _white(self, coefficients: Complexes) -> Floats:
        white = self._inverse @ coefficients
        parts = np.stack([white.real, white.imag], axis=2)
        return parts.reshape(parts.shape[0] * parts.shape[1] * 2, coefficients.shape[2])


def log_variances(covariance: Floats) -> Floats:
    """Return the logarithms of variances of joints, each given those before it, (…, n_joint)."""
    root = np.diagonal(np.linalg.cholesky(covariance), axis1=-2, axis2=-1)
    return np.asarray(2.0 * np.log(root), dtype=np.float64)


def _at(joint: int, torques: Floats, n_joint: int) -> Floats:
    rows = np.zeros((len(torques), n_joint, torques.shape[1]))
    rows[:, joint] = torques
    return rows


def _orthonormal(columns: Floats) -> Floats:
    """Return an orthonormal basis of what columns span."""
    size = np.linalg.norm(columns, axis=0)
    columns = columns[:, size > _ROUNDING * size.max(initial=0.0)]
    if not columns.shape[1]:
        return columns
    Q, R, _ = scipy.linalg.qr(columns / np.linalg.norm(columns, axis=0), mode="economic", pivoting=True)
    kept = np.abs(np.diag(R)) > _ROUNDING
    return np.ascontiguousarray(Q[:, : len(kept)][:, kept])


def _singular(columns: Floats) -> tuple[Floats, Floats]:
    """Return the left singular vectors of columns and their values, without those that rounding makes."""
    squared, axes = scipy.linalg.eigh(columns.T @ columns)
    kept = squared > _ROUNDING**2 * max(float(squared.max(initial=0.0)), 1.0)
    size = np.sqrt(squared[kept])
    return columns @ (axes[:, kept] / size), size
