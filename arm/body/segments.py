"""Mass, centre of mass and inertia of a person's segments by sex, from mass and stature.

All shares are those of de Leva (J. Biomech. 29, 1996), who moved the ends of Zatsiorsky's gamma-ray scans (100
men, 15 women) to the joints' centres. They are a prior of young adults: a person differs by some 20 %.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from arm.model import Floats, Link

Sex = Literal["f", "m"]

#: Stature of the persons scanned [m]; lengths of segments go in proportion to it.
_STATURE_M = {"f": 1.735, "m": 1.741}


@dataclass(frozen=True)
class Share:
    """A segment of the mean person of one sex.

    Attributes
    ----------
    mass : float
        As a share of the body's.
    length_m : float [m]
        From the centre of the joint before it to the next one.
    centre : float
        Of mass, from there on, as a share of the length.
    gyration : (3,)
        Radii of gyration about sagittal, transverse and longitudinal axis, as shares of the length.
    """

    mass: float
    length_m: float
    centre: float
    gyration: tuple[float, float, float]


#: Trunk and head from the upper end down, as the table has them; all others away from the trunk.
_SHARES: dict[str, dict[str, Share]] = {
    "head": {  # from the vertex to the seventh cervical vertebra
        "f": Share(0.0668, 0.2437, 0.4841, (0.271, 0.295, 0.261)),
        "m": Share(0.0694, 0.2429, 0.5002, (0.303, 0.315, 0.261)),
    },
    "upper_trunk": {  # from the suprasternal notch to the xiphoid
        "f": Share(0.1545, 0.1425, 0.2077, (0.746, 0.502, 0.718)),
        "m": Share(0.1596, 0.1707, 0.2999, (0.716, 0.454, 0.659)),
    },
    "middle_trunk": {  # from there to the navel
        "f": Share(0.1465, 0.2053, 0.4512, (0.433, 0.354, 0.415)),
        "m": Share(0.1633, 0.2155, 0.4502, (0.482, 0.383, 0.468)),
    },
    "lower_trunk": {  # from there to the middle between the hips' centres
        "f": Share(0.1247, 0.1815, 0.4920, (0.433, 0.402, 0.444)),
        "m": Share(0.1117, 0.1457, 0.6115, (0.615, 0.551, 0.587)),
    },
    "upper_arm": {
        "f": Share(0.0255, 0.2751, 0.5754, (0.278, 0.260, 0.148)),
        "m": Share(0.0271, 0.2817, 0.5772, (0.285, 0.269, 0.158)),
    },
    "forearm": {
        "f": Share(0.0138, 0.2643, 0.4559, (0.261, 0.257, 0.094)),
        "m": Share(0.0162, 0.2689, 0.4574, (0.276, 0.265, 0.121)),
    },
    "hand": {  # to the head of the third metacarpal
        "f": Share(0.0056, 0.0780, 0.7474, (0.531, 0.454, 0.335)),
        "m": Share(0.0061, 0.0862, 0.7900, (0.628, 0.513, 0.401)),
    },
    "thigh": {
        "f": Share(0.1478, 0.3685, 0.3612, (0.369, 0.364, 0.162)),
        "m": Share(0.1416, 0.4222, 0.4095, (0.329, 0.329, 0.149)),
    },
    "shank": {  # to the lateral malleolus
        "f": Share(0.0481, 0.4323, 0.4416, (0.271, 0.267, 0.093)),
        "m": Share(0.0433, 0.4340, 0.4459, (0.255, 0.249, 0.103)),
    },
    "foot": {  # from the heel to the tip of the longest toe
        "f": Share(0.0129, 0.2283, 0.4014, (0.299, 0.279, 0.139)),
        "m": Share(0.0137, 0.2581, 0.4415, (0.257, 0.245, 0.124)),
    },
}

SEGMENTS = tuple(_SHARES)
#: Height of the seventh cervical vertebra and of the shoulders' centres above the hips', standing [m].
_ABOVE_HIPS_M = {"c7": {"f": 0.6148, "m": 0.6033}, "shoulders": {"f": 0.4979, "m": 0.5155}}


@dataclass(frozen=True)
class Segment:
    """A segment of a person.

    Attributes
    ----------
    mass_kg, length_m : float
    centre_m : float [m]
        Of mass, from the joint before it.
    inertia_kg_m2 : (3,)
        About sagittal, transverse and longitudinal axis through the centre of mass.
    """

    mass_kg: float
    length_m: float
    centre_m: float
    inertia_kg_m2: tuple[float, float, float]

    def link(self, begin: Floats, axes: Floats, frame: Floats) -> Link:
        """Return it as a link.

        Parameters
        ----------
        begin : (3,) [m]
            Where it begins.
        axes : (3, 3)
            Sagittal, transverse and longitudinal axis as columns; the last points along the segment.
        frame : (4, 4)
            Pose of the link's joint-axis frame, in the same coordinates.
        """
        R = frame[:3, :3]
        centre = R.T @ (begin + self.centre_m * axes[:, 2] - frame[:3, 3])
        own = R.T @ axes @ np.diag(self.inertia_kg_m2) @ axes.T @ R
        about = own + self.mass_kg * (centre @ centre * np.eye(3) - np.outer(centre, centre))  # Steiner
        x, y, z = (float(s) for s in centre)
        six = [float(about[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        return Link(self.mass_kg, (x, y, z), (six[0], six[1], six[2], six[3], six[4], six[5]))


def segment(name: str, mass_kg: float, height_m: float, sex: Sex) -> Segment:
    """Return a segment of a person of some mass, stature and sex.

    Parameters
    ----------
    name : str
        One of `SEGMENTS`.
    mass_kg, height_m : float
        Of the whole person.
    sex : {"f", "m"}
    """
    share = _SHARES[name][sex]
    mass, length = share.mass * mass_kg, share.length_m * height_m / _STATURE_M[sex]
    sagittal, transverse, longitudinal = (mass * (radius * length) ** 2 for radius in share.gyration)
    return Segment(mass, length, share.centre * length, (sagittal, transverse, longitudinal))


def above_hips_m(point: str, height_m: float, sex: Sex) -> float:
    """Return how high ``c7`` or ``shoulders`` are above the hips' centres of a standing person."""
    return _ABOVE_HIPS_M[point][sex] * height_m / _STATURE_M[sex]


def together(links: Sequence[Link]) -> Link:
    """Return links of one frame as one link."""
    mass = sum(link.mass_kg for link in links)
    x, y, z = (sum(link.mass_kg * link.com_m[k] for link in links) / mass for k in range(3))
    xx, yy, zz, xy, xz, yz = (sum(link.inertia_kg_m2[k] for link in links) for k in range(6))
    return Link(mass, (x, y, z), (xx, yy, zz, xy, xz, yz))
