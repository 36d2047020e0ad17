"""The arm's structure: which of its axes are meant to be parallel or square to each other.

A calibrated angle of a milliradian where the arm is flat would make a dozen more combinations of its inertial
parameters visible in principle, and none of them in any data. The base parameters are therefore those of the
structure; the regressor itself keeps the angles as they were found.
"""

from dataclasses import replace

import numpy as np

from arm.base_parameters import BaseParameters, base_parameters
from arm.model import Arm, Floats

#: Axes this close to parallel or square are taken to be so [rad]; about a degree.
_MEANT = 0.0175


def structural(arm: Arm) -> Arm:
    """Return the arm with alpha and beta at the multiple of a right angle that they are close to."""
    alpha, beta = (np.array([getattr(joint, name) for joint in arm.joints]) for name in ("alpha_rad", "beta_rad"))
    return arm.with_joints(alpha_rad=_snapped(alpha), beta_rad=_snapped(beta))


def structural_parameters(arm: Arm) -> BaseParameters:
    """Return the base parameters of an arm's structure.

    Where the arm as it is has no more of them, they are its own exactly: an angle that is a degree off a right one
    then adds nothing that no data could tell, and to leave it out would shift what is determined.
    """
    as_meant = structural(arm)
    own = base_parameters(arm)
    if as_meant == arm:
        return own
    meant = base_parameters(as_meant)
    return replace(meant, combination=own.combination) if own.independent == meant.independent else meant


def _snapped(angle: Floats) -> Floats:
    meant = np.round(angle / (np.pi / 2)) * (np.pi / 2)
    return np.where(np.abs(angle - meant) < _MEANT, meant, angle)
