"""Markers in the world, the base's pose and the weights of a limb's frames, as the kernels take them."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.marker_kinematics import Integers, MarkerChain
from arm.model import Floats
from fitter.limb.free_geometry import Geometry

#: Degrees of freedom of the t distribution of a marker's error: heavy tails, so that a label that is wrong for
#: some frames has no say (Lange, Little and Taylor 1989 use 4 where they are not known).
FREEDOM = 4.0


class Frames(NamedTuple):
    """Frames of some trials, one after the other.

    Attributes
    ----------
    y : (n_frame, m, 3) [m]
        Markers in the world, NaN where one was not seen.
    R, p : (n_frame, 3, 3), (n_frame, 3)
        The pose of the segment that carries the base; it is known in every frame.
    trial : (n_frame,) int64
        Which trial a frame is of.
    t : (n_frame,) [s]
    """

    y: Floats
    R: Floats
    p: Floats
    trial: Integers
    t: Floats

    def rows(self, which: NDArray[np.bool_] | Integers) -> "Frames":
        """Return some of the frames."""
        return Frames(*(part[which] for part in self))


class AnglePrior(NamedTuple):
    """What is known of the joints before a marker is seen: a weak normal prior, so that no angle is left open.

    Attributes
    ----------
    mean, information : (n_joint,)
        In rad (or m), and one over its variance.
    """

    mean: Floats
    information: Floats


@dataclass(frozen=True)
class MarkerModel:
    """Markers on the links of a limb.

    Attributes
    ----------
    names : tuple of str
    link : (m,) int64
        From 0.
    place : (m, 3) [m]
        In the link's joint-axis frame.
    std : (m,) [m]
        How far each wanders along an axis.
    """

    names: tuple[str, ...]
    link: Integers
    place: Floats
    std: Floats

    def chain(self, geometry: Geometry) -> MarkerChain:
        """Return the chain with these markers; all joints turn."""
        n = len(geometry.numbers)
        return MarkerChain(
            np.ones(n, dtype=np.bool_),
            np.ascontiguousarray(geometry.numbers),
            self.link,
            np.ascontiguousarray(self.place),
            np.ascontiguousarray(geometry.base_R),
            np.ascontiguousarray(geometry.base_p),
        )
