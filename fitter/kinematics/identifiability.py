"""Which geometric parameters are identifiable from tip displacements, and which are set by convention.

Some numbers of eq. (1) never show in the displacement of the tip (d along parallel axes, the height of the
base), some only together with others (where a joint's zero is, and where the link after it points), some not
in this data (a joint that did not move). Parameters are taken one by one, those first that one would rather
learn: lengths, then twists, then offsets along axes, and joint zeros last. One that adds nothing to those
before it stays at its prior.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.kinematics.tip_basis import GEOMETRY, geometry_of

#: Earlier in this list is learnt rather.
_PREFERENCE = ("a", "alpha", "beta", "d", "theta_offset")
#: Axes that are parallel to within this angle get beta, and their d is suppressed (Hayati 1983).
NEARLY_PARALLEL_RAD = float(np.deg2rad(10.0))
#: A parameter that moves the tip by less than this (rms) over its whole range is not identifiable.
RESOLUTION_M = 2e-3
#: The same as a share of what the parameter would do if it were the only one.
SMALLEST_SHARE = 1e-4


def sought_by_default(arm: Arm) -> NDArray[np.bool_]:
    """Return which numbers of eq. (1) take part in a search, (n_joint, 5).

    Not alpha, d and beta of joint 1, which say how the arm stands in its base frame; not d between axes that
    are nearly parallel; not beta between axes that are not.
    """
    sought = np.ones((arm.n_joint, len(GEOMETRY)), dtype=bool)
    parallel = _nearly_parallel(arm)
    sought[:, GEOMETRY.index("d")] = ~parallel
    sought[:, GEOMETRY.index("beta")] = parallel
    sought[0, [GEOMETRY.index(name) for name in ("alpha", "d", "beta")]] = False
    return sought


def identifiable(effects: Floats, which: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Say which parameters have an effect on the tip that those before them don't have.

    Parameters
    ----------
    effects : (n_parameter, n)
        What each does to the tip if it goes through its whole range, in coordinates in which the length of a
        row is the rms displacement [m].
    which : (n_parameter,) int
        Places in the flattened geometry.

    Returns
    -------
    (n_parameter,) bool
    """
    is_determined, known = np.zeros(len(which), dtype=bool), np.zeros((0, effects.shape[1]))
    for k in by_preference(which):
        new = effects[k]
        for _ in range(2):  # once more, for the rounding of the first time
            new = new - known.T @ (known @ new)
        size = float(np.linalg.norm(new))
        if size > max(RESOLUTION_M, SMALLEST_SHARE * float(np.linalg.norm(effects[k]))):
            is_determined[k] = True
            known = np.vstack([known, new / size])
    return is_determined


def with_parallel_axes(arm: Arm, geometry: Floats) -> Floats:
    """Return a geometry in which the axes that are nearly parallel in an arm are so exactly, (n_joint, 5)."""
    parallel, exactly = _nearly_parallel(arm), geometry.copy()
    alpha, beta = GEOMETRY.index("alpha"), GEOMETRY.index("beta")
    exactly[parallel, alpha] = np.pi * np.round(geometry[parallel, alpha] / np.pi)
    exactly[parallel, beta] = 0.0
    return exactly


def _nearly_parallel(arm: Arm) -> NDArray[np.bool_]:
    return np.asarray(np.abs(np.sin(geometry_of(arm)[:, 0])) < np.sin(NEARLY_PARALLEL_RAD))


def by_preference(which: NDArray[np.intp]) -> list[int]:
    """Return the order in which parameters at these places of the flattened geometry are taken."""
    return sorted(
        range(len(which)), key=lambda k: (_PREFERENCE.index(GEOMETRY[which[k] % len(GEOMETRY)]), which[k])
    )
