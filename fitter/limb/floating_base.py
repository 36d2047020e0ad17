"""A base that floats by joints of its own: which joints those are, and where its own markers have it."""

from dataclasses import replace

import numpy as np

from arm.model import Arm, Floats
from fitter.limb.free_geometry import Geometry
from fitter.limb.inverse_kinematics import follow
from fitter.limb.marker_observations import AnglePrior, Frames, MarkerModel

#: Joints of a floating base: three that slide, three that turn.
FLOATING = 6


def floating_joints(arm: Arm) -> int:
    """Return how many joints the floating base has: the first six where they slide and turn freely, else none."""
    first = [joint.type for joint in arm.joints[:FLOATING]]
    serial = arm.parents[:FLOATING] == tuple(range(-1, FLOATING - 1))
    return FLOATING if first == ["prismatic"] * 3 + ["revolute"] * 3 and serial else 0


def floating_angles(
    geometry: Geometry, markers: MarkerModel, frames: Frames, prior: AnglePrior, seed: int
) -> Floats:
    """Return where the markers of the link that floats have it, all other joints at the prior's mean.

    Parameters
    ----------
    geometry : Geometry
        Of a tree whose first six joints float.
    markers : MarkerModel
    frames : Frames
    prior : AnglePrior
    seed : int

    Returns
    -------
    (n_frame, n_joint)
        With fewer than three markers on that link the mean throughout.
    """
    q, n = np.tile(prior.mean, (len(frames.y), 1)), FLOATING
    on_it = markers.link == n - 1
    if on_it.sum() < 3:
        return q
    alone = replace(
        geometry,
        numbers=geometry.numbers[:n],
        revolute=geometry.revolute[:n],
        parent=geometry.parent[:n],
        hang=geometry.hang[:n],
    )
    own = replace(
        markers,
        names=tuple(name for name, on in zip(markers.names, on_it.tolist(), strict=True) if on),
        link=markers.link[on_it],
        place=markers.place[on_it],
        std=markers.std[on_it],
    )
    seen = frames._replace(y=np.ascontiguousarray(frames.y[:, on_it]))
    few = AnglePrior(prior.mean[:n].copy(), prior.information[:n].copy())
    q[:, :n] = follow(own.chain(alone), seen, own.std, few, seed)
    return q
