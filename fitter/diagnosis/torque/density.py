r"""The density of what was measured: what makes residuals of different models comparable.

A residual ``r`` of the torque equation says how likely the data were only together with its slope with respect to
them: a model that makes both sides smaller makes the slope smaller, too. Three errors have three slopes:

- the sensors' noise, and errors of the motion that have its spectrum: the residual's own noise ``S_n`` (a
  functional errors-in-variables model);
- a white missing torque where the torque was measured: it is an error of that torque, whose slope is what the
  drive passes on of it;
- a white missing torque where it was not: it moved the arm, and the slope is the masses.

Each coefficient counts by the part phi of its variance that is the white floor's,

.. math:: \tfrac12 (1 - \phi) \log |S_n| + \tfrac12 \phi \log |S_a|, \qquad \phi = D / S,

both in units of what they are under the base model, so that it makes no difference by itself what phi is. ``S_a``
is the covariance of what white torques, or white accelerations, of variance one make of the residual.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.torque.noise import with_floor
from fitter.diagnosis.torque.spectra import Complexes
from fitter.diagnosis.torque.weights import Weights, log_variances

_SEED = 21
#: No direction of the joints has less mass than this part of the most: that is rounding.
_SINGULAR = 1e-12


@dataclass(frozen=True)
class Density:
    """Logarithms of variances under a model, in one motion.

    Attributes
    ----------
    sensors : (n_frequency, n_joint)
    masses : (n_joint,)
    """

    sensors: Floats
    masses: Floats


def shaken(motions: Sequence[Motion], torque_measured: bool) -> dict[int, Motion]:
    """Return motions with white torques, or accelerations, of variance one a sample added, by their numbers."""
    rng = np.random.default_rng(_SEED)
    column = "u" if torque_measured else "ddq"
    found = {}
    for one in motions:
        values = getattr(one, column)
        found[one.number] = replace(one, **{column: values + rng.standard_normal(values.shape)})
    return found


def mass_covariance(draw: Complexes) -> Floats:
    """Return ``S_a`` by what white accelerations of variance one make of the torque.

    Parameters
    ----------
    draw : (n_frequency, n_joint) complex

    Returns
    -------
    (n_joint, n_joint)
    """
    covariance = 0.5 * np.real(draw.T @ draw.conj()) / len(draw)
    size = np.sqrt(np.maximum(np.diag(covariance), np.finfo(np.float64).tiny))
    values, axes = np.linalg.eigh(covariance / np.outer(size, size))
    return np.asarray((axes * np.maximum(values, _SINGULAR)) @ axes.T * np.outer(size, size))


def of_model(floor: Floats, weights: Weights, own: Floats) -> Floats:
    """Return phi, (n_frequency, n_joint).

    Parameters
    ----------
    floor : (2, n_joint)
        See `noise.with_floor`.
    weights : Weights
    own : (n_frequency, n_joint, n_joint)
        Covariance of the sensors' noise.
    """
    white = log_variances(with_floor(own, np.stack([0.0 * floor[0], floor[1]])))
    return np.asarray(np.clip(1.0 - np.exp(white - weights.log_variance), 0.0, 1.0))


def log_density(density: Density, reference: Density, phi: Floats, freedom: Floats) -> float:
    """Return the logarithm of a motion's density but for its residual, by both slopes [nats]."""
    sensors = (1.0 - phi) * (density.sensors - reference.sensors)
    masses = phi * (density.masses - reference.masses)
    return float(np.sum(freedom * (sensors + masses + reference.sensors)))
