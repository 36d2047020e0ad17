"""How well a motion tells the base parameters: errors of a fit that weights each joint by its torque's noise."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.simulation import Motion
from fitter.data.standstill import REST_SPEED
from fitter.regression_sums.torque_sums import torque_sums

#: Noise of the torque in every sample, as a share of its rms in the random motion.
NOISE = 0.01
#: What the scaled information must not fall below to be inverted: less is nothing.
_NOTHING = 1e-12


@dataclass(frozen=True)
class Precision:
    """What some motion tells of the base parameters.

    Attributes
    ----------
    condition_number : float
        Of the weighted regressor, its columns scaled to length one.
    std : (n_base,)
        Standard errors; infinite where the motion tells nothing.
    """

    condition_number: float
    std: Floats


def information(arm: Arm, base: BaseParameters, motion: Motion, noise: Floats) -> Floats:
    """Return the sums of the regressor's products, each joint weighted by its noise, (n_base, n_base).

    Parameters
    ----------
    arm : Arm
    base : BaseParameters
    motion : Motion
    noise : (n_joint,) [N m or N]
        Of each sample's torque, white.
    """
    sums = torque_sums(arm, base, motion.q, motion.dq, motion.ddq, motion.tau, REST_SPEED)
    return np.asarray(np.einsum("jab,j->ab", sums.gram.sum(axis=0), noise**-2.0), dtype=np.float64)


def precision_of(gram: Floats) -> Precision:
    """Return what a motion with this information tells."""
    scale = np.sqrt(np.diag(gram))
    seen = scale > 0.0
    std = np.full(len(gram), np.inf)
    if not seen.any():
        return Precision(np.inf, std)
    unit = gram[np.ix_(seen, seen)] / np.outer(scale[seen], scale[seen])
    values, axes = scipy.linalg.eigh(unit)
    values = np.maximum(values, _NOTHING)
    std[seen] = np.sqrt(np.sum(axes**2 / values, axis=1)) / scale[seen]
    condition = float(np.sqrt(values[-1] / values[0])) if seen.all() else np.inf
    return Precision(condition, std)
