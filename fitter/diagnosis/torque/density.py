r"""The density of a motion: what makes residuals of models with different masses comparable.

A residual ``r`` of the torque equation says how likely the *motion* was only together with the slope of ``r`` with
respect to it. Where sensors' noise is all there is, that slope is the residual's noise ``S_n`` itself (a functional
errors-in-variables model); where the model lacks something, a missing torque moved the arm, and the slope is that of
the accelerations: the mass matrix. Each coefficient counts by the part phi of its variance that is the model's own,

.. math:: \tfrac12 (1 - \phi) \log |S_n| + \tfrac12 \phi \log |S_a|, \qquad \phi = 1 - S_n / S, \quad S_a = E[M M^T]

both in units of what they are under the base model, so that it makes no difference by itself what phi is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.motion import Motion
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


def shaken(motions: Sequence[Motion]) -> dict[int, Motion]:
    """Return motions with white accelerations of variance one a sample added, by their numbers."""
    rng = np.random.default_rng(_SEED)
    return {one.number: replace(one, ddq=one.ddq + rng.standard_normal(one.ddq.shape)) for one in motions}


def mass_covariance(draw: "np.ndarray") -> Floats:
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


def of_model(own: Floats, weights: Weights) -> Floats:
    """Return phi, (n_frequency, n_joint).

    Parameters
    ----------
    own : (n_frequency, n_joint, n_joint)
        Covariance of the sensors' noise.
    weights : Weights
    """
    return np.asarray(np.clip(1.0 - np.exp(log_variances(own) - weights.log_variance), 0.0, 1.0))


def log_density(density: Density, reference: Density, phi: Floats, freedom: Floats) -> float:
    """Return the logarithm of a motion's density but for its residual, by both slopes [nats]."""
    sensors = (1.0 - phi) * (density.sensors - reference.sensors)
    masses = phi * (density.masses - reference.masses)
    return float(np.sum(freedom * (sensors + masses + reference.sensors)))
