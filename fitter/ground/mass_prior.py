"""How far a person's segments are from the table's, before anything is measured: a prior with its covariance.

The spread is in the numbers of `fitter.ground.deformation`. It holds what a person differs by from others of the
same mass and stature, and what the tables differ by among themselves and where they are put: a joint's centre
that is known to a centimetre or two moves a segment's centre of mass in the link's frame as much.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.ground.deformation import MASS, N_BODY, SHAPE, SHIFT

#: Standard deviation of a segment's mass, as a share. Regressions on mass and stature leave 6 to 15 % (Zatsiorsky,
#: Kinetics of Human Motion, 2002, tables A2.6 and A2.7); tables of different populations lie as far apart again.
MASS_SHARE = 0.2
#: Of the centre's place, in radii of gyration: 0.3 of a limb segment's length, so 8 % of it. The same regressions
#: leave 1 to 4 % of the length; hip, knee and shoulder centres by regression or function add 10 to 25 mm.
CENTRE_RADII = 0.25
#: Of the radii themselves, as a share: the same regressions leave 12 to 25 % of a moment of inertia.
RADIUS_SHARE = 0.1
#: Of the whole person's mass, as a share: scales, and clothes and shoes of half a kilogram to one.
TOTAL_SHARE = 0.015
#: What multiplies all of it where no table is given: the links of the arm file are then hardly more than a
#: beginning.
VAGUE = 10.0


@dataclass(frozen=True)
class MassPrior:
    """A normal distribution of the numbers of `fitter.ground.deformation`.

    Attributes
    ----------
    mean : (10 n_body,)
    covariance : (10 n_body, 10 n_body)
    """

    mean: Floats
    covariance: Floats


def table_prior(mass_kg: Floats, total_kg: float | None) -> MassPrior:
    """Return the prior of bodies whose links are the table's.

    Parameters
    ----------
    mass_kg : (n_body,)
        The table's.
    total_kg : float, optional
        Of the whole person, by a scale: where one segment is heavier, others are lighter.
    """
    n = len(mass_kg)
    std = np.empty((n, N_BODY))
    std[:, MASS], std[:, SHIFT], std[:, SHAPE] = MASS_SHARE, CENTRE_RADII, RADIUS_SHARE
    mean, covariance = np.zeros(n * N_BODY), np.diag(std.ravel() ** 2)
    if total_kg is None:
        return MassPrior(mean, covariance)
    # sum m_i (1 + mu_i) = total, as one more observation
    row = np.zeros(n * N_BODY)
    row[MASS::N_BODY] = mass_kg
    gain = covariance @ row / (row @ covariance @ row + (TOTAL_SHARE * total_kg) ** 2)
    mean = gain * (total_kg - mass_kg.sum())
    return MassPrior(mean, covariance - np.outer(gain, row @ covariance))


def vague_prior(n_body: int) -> MassPrior:
    """Return a prior so wide that what is measured at all is not drawn to it."""
    wide = table_prior(np.ones(n_body), None)
    return MassPrior(wide.mean, VAGUE**2 * wide.covariance)
