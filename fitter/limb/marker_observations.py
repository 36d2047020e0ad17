"""Observed markers, the base's pose and the weights of a limb's frames, as the kernels take them."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.marker_kinematics import BASE_POSITION, BASE_ROTATION, Integers, MarkerChain, marker_chain
from arm.model import Floats
from fitter.limb.free_geometry import Geometry

#: Degrees of freedom of the t distribution of a marker's error: heavy tails, so that a label that is wrong for
#: some frames has no say (Lange, Little and Taylor 1989 use 4 where they are not known).
FREEDOM = 4.0


#: The base's sway: three sliding and three turning joints before the limb's own, along and about frame 0's axes.
#: They take up by how much skin lets the base segment's markers miss the joint that they carry, and bring the base
#: where too few of its markers are seen. alpha, a, d, beta, theta offset of each.
SWAY = 6
_ALONG_AXES = np.array([[0.0, 0.0, 0.0, 0.5, 0.0], [-0.5, 0.0, 0.0, -0.5, 0.0], [0.5, 0.0, 0.0, 0.0, 0.0]])
_SWAY_TURNS = np.arange(SWAY) >= SWAY // 2
_SWAY_ROWS = np.vstack([_ALONG_AXES, _ALONG_AXES]) * np.array([np.pi, 1.0, 1.0, np.pi, np.pi])
#: Standard deviation of a sway that cannot be [m or rad], and of one that markers determine [m], [rad].
_NO_SWAY, _FREE_M, _FREE_RAD = 1e-6, 0.05, 0.3
#: … and of one of a base that may be anywhere in a laboratory [m].
_ANYWHERE_M = 10.0


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
        return Frames(self.y[which], self.R[which], self.p[which], self.trial[which], self.t[which])


class AnglePrior(NamedTuple):
    """What is known of sway and joints before a marker is seen: of the joints a weak normal prior.

    Attributes
    ----------
    mean, information : (6 + n_joint,)
        In m and rad, and one over its variance.
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
        From 0; -1 is frame 0.
    place : (m, 3) [m]
        In the link's joint-axis frame.
    std : (m,) [m]
        How far each wanders along an axis.
    sway : int
        Joints of the base's sway before the limb's own: `SWAY`; none where the base floats by joints of its own.
    """

    names: tuple[str, ...]
    link: Integers
    place: Floats
    std: Floats
    sway: int = SWAY

    def chain(self, geometry: Geometry) -> MarkerChain:
        """Return the chain with these markers, the base's sway before it."""
        sway = self.sway
        parent = np.concatenate([np.arange(sway) - 1, geometry.parent + sway])
        hang = np.vstack([np.zeros((sway, 4)), geometry.hang])
        return marker_chain(
            np.concatenate([_SWAY_TURNS[:sway], geometry.revolute]),
            np.ascontiguousarray(np.vstack([_SWAY_ROWS[:sway], geometry.numbers])),
            self.link + sway,
            np.ascontiguousarray(self.place),
            np.ascontiguousarray(geometry.base_R),
            np.ascontiguousarray(geometry.base_p),
            parent,
            hang,
        )


def swayed(what: Integers, sway: int) -> Integers:
    """Return free numbers of eq. (1) by their joint in the chain with the base's sway before it, (n_free, 2)."""
    moved = what.copy()
    of_joint = (what[:, 0] != BASE_POSITION) & (what[:, 0] != BASE_ROTATION)
    moved[:, 1] += np.where(of_joint, sway, 0)
    return moved


def base_sways(prior: AnglePrior, std_m: float) -> AnglePrior:
    """Return the prior of a limb whose base only shifts, with this standard deviation along each axis."""
    sway = np.concatenate([np.full(3, max(std_m, _NO_SWAY)), np.full(3, _NO_SWAY)])
    return _with_sway(prior, sway)


def base_follows(prior: AnglePrior, n_marker: int) -> AnglePrior:
    """Return the prior of a limb whose base is where its own markers, and the limb, have it.

    Parameters
    ----------
    prior : AnglePrior
    n_marker : int
        Of the base: with fewer than three it keeps its orientation, with none its place.
    """
    sway = np.full(SWAY, _NO_SWAY)
    sway[:3] = _FREE_M if n_marker else _NO_SWAY
    sway[3:] = _FREE_RAD if n_marker >= 3 else _NO_SWAY
    return _with_sway(prior, sway)


def base_anywhere(prior: AnglePrior) -> AnglePrior:
    """Return the prior of a limb that tells where its base is; the base keeps its orientation as before."""
    information = prior.information.copy()
    information[: SWAY // 2] = _ANYWHERE_M**-2
    return AnglePrior(prior.mean, information)


def _with_sway(prior: AnglePrior, std: Floats) -> AnglePrior:
    return AnglePrior(prior.mean, np.concatenate([std**-2, prior.information[SWAY:]]))


def with_base(model: MarkerModel, names: tuple[str, ...], place: Floats, std_m: float) -> MarkerModel:
    """Return the markers of a limb and after them those of its base, whose places are in frame 0."""
    return replace(
        model,
        names=(*model.names, *names),
        link=np.concatenate([model.link, np.full(len(names), -1, dtype=np.int64)]),
        place=np.vstack([model.place, place.reshape(-1, 3)]),
        std=np.concatenate([model.std, np.full(len(names), std_m)]),
    )
