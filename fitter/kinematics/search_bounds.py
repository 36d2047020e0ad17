"""Where a geometry is searched."""

from collections.abc import Mapping, Sequence

import numpy as np

from arm.model import Floats
from fitter.kinematics.tip_basis import GEOMETRY
from limbcal.errors import ConfigError

#: Where nothing is known: lengths up to a metre, angles to 30 degrees and offsets to half a metre around the
#: arm file's.
LONGEST_LINK_M = 1.0
_AROUND = {"alpha": np.pi / 6, "d": 0.5, "beta": np.pi / 6, "theta_offset": np.pi / 6}


def search_bounds(
    names: Sequence[str], prior: Floats, given: Mapping[str, tuple[float, float]]
) -> tuple[Floats, Floats]:
    """Return the lower and the upper bounds of all parameters, (n_parameter,) each.

    Raises
    ------
    ConfigError
        If bounds are not finite or the wrong way round.
    """
    bounds = np.empty((2, len(names)))
    for k, name in enumerate(names):
        kind = GEOMETRY[k % len(GEOMETRY)]
        around = _AROUND.get(kind, 0.0)
        default = (prior[k] - around, prior[k] + around)
        if kind == "a":
            default = (min(0.0, 2.0 * prior[k]), max(LONGEST_LINK_M, 2.0 * prior[k]))
        low, high = given.get(name, default)
        if not -np.inf < low <= high < np.inf:
            raise ConfigError(f"bounds of {name} are {low} and {high}, expected finite and ordered")
        bounds[:, k] = low, high
    return bounds[0], bounds[1]
