"""Base parameters that no body has: a tilt of next to no gravity takes moments of tons to turn an arm.

Where the arm file knows of no gravity in the plane, a tilt brings a link's first moment with it, and only their
product is told: with a spring beside it, a sine of any size makes the cube of a small angle. A body whose moment
is ``m s`` and whose inertia about the same axis is ``J`` has a radius of gyration of at most ``J / |m s|``, for it
is no less than the distance ``s`` of the centre of mass.
"""

import numpy as np

from arm.regressor import INERTIAL
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate

#: No body turns about an axis with a radius of gyration of less than this share of the arm's longest link.
_LEAST = 0.02
_ZZ, _SX, _SY = (INERTIAL.index(name) for name in ("I{}zz", "m{}*sx{}", "m{}*sy{}"))


def has_bodies(regression: Regression, candidate: Candidate) -> bool:
    """Say whether bodies can have the moments that a model with a tilt of gravity asks for.

    Parameters
    ----------
    regression : Regression
    candidate : Candidate
    """
    if all(hypothesis.kind.name != "gravity_tilt" for hypothesis in candidate.model.hypotheses):
        return True
    arm = regression.view(candidate.model, regression.motions[0]).arm
    longest = max(max(abs(joint.a_m), abs(joint.d_m)) for joint in arm.joints)
    columns = regression.equations.independent(arm)
    values = dict(zip(columns.tolist(), candidate.x[: len(columns)].tolist(), strict=True))
    for first in range(0, len(INERTIAL) * arm.n_joint, len(INERTIAL)):
        moment = np.hypot(values.get(first + _SX, 0.0), values.get(first + _SY, 0.0))
        inertia = values.get(first + _ZZ)
        if inertia is not None and _LEAST * longest * moment > max(inertia, 0.0):
            return False
    return True
