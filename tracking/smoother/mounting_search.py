"""How sensors are mounted where a careful mounting as the file has it does not explain the readings."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from arm.model import Arm, Floats
from tracking.model.initial_state import ROUGH, MountingPrior
from tracking.model.readings import Readings
from tracking.smoother.orientations import EQUAL_NATS, likely_orientations, log_likelihood, right_angles, turned

#: Said where no orientation is near.
_NONE_NEAR = (
    "whether axes are exchanged or reversed does not show: in no orientation do lengths and places come out near "
    "the file's, so sensors are taken to be turned as the file says"
)


class Mounting(NamedTuple):
    """How sensors are mounted.

    Attributes
    ----------
    arm : Arm
        With its sensors turned as they were found.
    prior : MountingPrior
        How far off they may be from that.
    axes : dict of str to str
        Of each sensor that is turned: which axes of the file's its x, y and z are, such as ``y -x z``.
    undecided : list of str
        What the readings could not tell, a sentence each.
    is_found : bool
        Whether in some orientation lengths and places are near the file's; otherwise axes are the file's.
    """

    arm: Arm
    prior: MountingPrior
    axes: dict[str, str]
    undecided: list[str]
    is_found: bool = True


def likely_mounting(
    arm: Arm,
    readings: Readings,
    q: Floats,
    given: bool,
    prior: MountingPrior,
    progress: Callable[[int], None] | None = None,
) -> Mounting:
    """Return how sensors are mounted: as the file says within the prior, if nothing is a hundred times likelier.

    What is likelier counts only if lengths and places are then near the file's: turned sensors in far places
    follow what a rigid arm on a base at rest does not do, such as the leg of a person who walks.

    Parameters
    ----------
    arm, q, given, prior
        As of `tracking.smoother.smoother.Smoother`.
    readings : Readings
    progress : callable, optional
        Told how many orientations were tried.
    """
    ways = likely_orientations(arm, readings, q, given, ROUGH, progress)
    best = ways[0]
    if not best.is_near:  # a model that does not describe these readings prefers any axes to others
        return Mounting(arm, prior, {}, [_NONE_NEAR], False)
    as_told = log_likelihood(arm, readings, q, given, prior)
    if not np.isfinite(best.log_likelihood) or as_told > best.log_likelihood - EQUAL_NATS:
        return Mounting(arm, prior, {}, [])
    equal = [one for one in ways if one.is_near and one.log_likelihood > best.log_likelihood - EQUAL_NATS]
    # the file's where nothing shows, then the one that began nearest to where the arm is held to rest
    best = max(equal, key=lambda one: (sum(way == 0 for way in one.ways), one.log_prior), default=best)
    names = [sensor.name for sensor in arm.sensors]
    axes = {name: axes_of(way) for name, way in zip(names, best.ways, strict=True) if way}
    undecided = []
    for one in equal:
        other = {n: w for n, w, found in zip(names, one.ways, best.ways, strict=True) if w != found}
        if other:
            said = ", ".join(f"{name} {axes_of(way)}" for name, way in other.items())
            undecided.append(f"equally likely are the axes {said}")
    return Mounting(turned(arm, best.ways), ROUGH, axes, undecided)


def axes_of(way: int) -> str:
    """Return which of the file's axes a sensor's x, y and z are, such as ``y -x z``."""
    R = right_angles()[way]
    order = np.abs(R).argmax(axis=0)
    return " ".join(("-" if R[axis, k] < 0.0 else "") + "xyz"[axis] for k, axis in enumerate(order.tolist()))
