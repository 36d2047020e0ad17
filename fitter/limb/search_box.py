"""Where the genetic algorithm seeks a limb's geometry: a box that knows nothing of the person."""

from dataclasses import dataclass

import numpy as np

from arm.marker_kinematics import ALPHA, BASE_POSITION, BASE_ROTATION, BETA
from arm.model import Floats
from fitter.limb.free_geometry import FreeGeometry, Geometry

#: No bone is longer (a femur is 0.27 of a person's height, Trotter and Gleser 1952), either way along an axis [m].
LONGEST_BONE_M = 0.6
#: Half the range of angles about the preset's axes, which are at right angles or parallel: that of
#: `fitter.kinematics.search_bounds` [rad].
HALF_RANGE_RAD = np.pi / 6
#: How far from its link's frame, or from the middle of its base, a marker or joint may begin, along an axis [m].
REACH_M = 0.3


@dataclass(frozen=True)
class SearchBox:
    """Bounds of the free numbers, counted from a geometry.

    Attributes
    ----------
    free : FreeGeometry
    origin : Geometry
    lower, upper : (n_free,) [rad or m]
    """

    free: FreeGeometry
    origin: Geometry
    lower: Floats
    upper: Floats

    def geometry(self, genes: Floats) -> Geometry:
        """Return the geometry that genes (n_free,) stand for."""
        return self.origin.moved(self.free, genes)


def search_box(free: FreeGeometry, about: Geometry, half_range_rad: float = HALF_RANGE_RAD) -> SearchBox:
    """Return the box of a limb.

    Parameters
    ----------
    free : FreeGeometry
    about : Geometry
        Only its angles count: they are the preset's. Lengths and frame 0's place are sought about zero.
    half_range_rad : float
        Of angles.
    """
    numbers, base_p = about.numbers.copy(), np.zeros(3)
    half = np.empty(len(free.what))
    for k, (kind, i) in enumerate(free.what):
        if kind in (ALPHA, BETA, BASE_ROTATION):
            half[k] = half_range_rad
        else:
            half[k] = REACH_M if kind == BASE_POSITION else LONGEST_BONE_M
            if kind != BASE_POSITION:
                numbers[i, kind] = 0.0
    origin = Geometry(numbers, about.base_R, base_p, about.revolute, about.parent, about.hang)
    return SearchBox(free, origin, -half, half)
