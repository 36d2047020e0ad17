"""How a link moves while its motor crosses the gap of a backlash.

The motor touches the side towards which it pulls. On its way across it passes on no torque, so the link coasts:
its angle and velocity go on as gravity, the other joints and its friction make them, while the motor's do not. How
it moved when the motor left and when that arrived is known from the angles beside the crossing, where it moved
with the motor; what the coasting lacks between both is a cubic (Hermite). After a rest, in which the motor's place
in its gap is unknown, the link begins to move at contact, and not before.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from arm.model import Floats
from fitter.diagnosis.contacts import CROSSING, FEW, Knot, Motor, Run
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, SIGMAS
from fitter.diagnosis.whitening import LASTS_S

#: Of a link whose place is known by one angle, and its velocity by what moved it.
_BY_ONE_ANGLE = np.diag([1.0, 0.0])


@dataclass(frozen=True)
class Coasting:
    """How a link moves beside its motor.

    Attributes
    ----------
    bridge : (n_sample,) [rad]
        What a crossing adds to the motor's angle and half the gap on the side where it is; 0 elsewhere.
    variance : (n_sample,)
        Of the bridge, in units of that of an angle's noise.
    side : (n_sample,)
        At which the motor is, -1 to 1.
    """

    bridge: Floats
    variance: Floats
    side: Floats


def coasting(motor: Motor) -> Coasting:
    """Return how a link coasts while its motor crosses."""
    n = len(motor.angle)
    bridge, variance, side = np.zeros((3, n))
    runs = motor.runs()
    for run in runs:
        side[run.first : run.last + 1] = run.side
    for before, after in pairwise([None, *runs, None] if runs else []):
        for left, right in pairwise(_known(motor, before, after)):
            samples = slice(left.at if left else 0, right.at + 1 if right else n)
            if samples.stop - samples.start > 1:
                path, variance[samples], side[samples] = _between(motor, left, right, samples)
                bridge[samples] = path - motor.angle[samples]
    return Coasting(bridge, variance, side)


def _known(motor: Motor, before: Run | None, after: Run | None) -> list[Knot | None]:
    """Return what is known between two contacts, ends included; a trial may begin or end with none.

    A motor that is suddenly asked for a torque crosses at once. From its touch on it accelerates the link evenly
    until it is seen to have arrived.
    """
    left = motor.departure(before) if before else None
    if after is None:
        return [left, None]
    begin, right = left.at if left else 0, motor.arrival(after)
    sudden = [at for at in motor.starts if begin + FEW <= at <= right.at]
    rests = (_rest(motor, left, begin, at) for at in reversed(sudden))  # a touch may be as sudden
    rest = next((one for one in rests if one is not None), None)
    free = rest or left
    if not sudden or free is None:
        return [left, right]
    asked = rest.at if rest is not None else sudden[-1]
    touch = min(max(right.at - motor.unsure, asked + CROSSING), right.at)
    moved, slopes = motor.coasted(free, slice(free.at, touch + 1))
    slope = float(slopes[-1])
    angle = right.angle - 0.5 * (right.at - touch) * (right.slope + slope)
    touched = Knot(touch, angle, slope, _BY_ONE_ANGLE, right.side)
    if rest is None:
        return [left, touched, right]
    if not rest.side:  # it rests within its gap: where it has to be to arrive
        rest = rest._replace(angle=angle - float(moved[-1] - moved[0]), side=right.side)
    return [left, rest, touched, right]


def _rest(motor: Motor, left: Knot | None, begin: int, start: int) -> Knot | None:
    """Return a link that rests until its motor is asked for a torque; None if it moves before.

    A torque, small but steady, that friction holds determines the side. Otherwise it is 0: the motor is somewhere
    within its gap, and so is its link.
    """
    lately = max(begin, start - round(LASTS_S / motor.dt_s))
    if not _is_still(motor, lately, start):
        return None
    still = begin
    if left is not None:
        _, slopes = motor.coasted(left, slice(begin, start))
        still += int(np.flatnonzero(slopes)[-1]) + 1 if np.any(slopes) else 0
    samples = slice(still if _is_still(motor, still, start) else lately, start)
    angle, torque = float(motor.angle[samples].mean()), motor.torque[samples]
    is_held = abs(torque.mean()) > SIGMAS * motor.noise[1] / np.sqrt(len(torque))
    return Knot(start, angle, 0.0, _BY_ONE_ANGLE, float(np.sign(torque.mean())) if is_held else 0.0)


def _is_still(motor: Motor, begin: int, end: int) -> bool:
    return end > begin and float(np.std(motor.angle[begin:end])) < EQUAL_SIGMAS * motor.noise[0]


def _between(motor: Motor, left: Knot | None, right: Knot | None, samples: slice) -> tuple[Floats, Floats, Floats]:
    """Return the link's path but for the gap, its variance, and the motor's side, between two knots."""
    n = samples.stop - samples.start
    if left is None:  # as it is found, or at rest
        assert right is not None
        t = np.arange(1.0 - n, 1.0)
        return right.angle + right.slope * t, _variance(right, [np.ones(n), t]), np.full(n, right.side)
    path, slopes = motor.coasted(left, samples)
    if right is None:
        moving = np.cumsum(slopes != 0.0)
        variance = _variance(left, [np.ones(n), moving]) + motor.wander(samples) * moving**3 / 3.0
        return path, variance, np.full(n, left.side)
    share = np.arange(n) / (n - 1)
    risen, rest = share**2 * (3.0 - 2.0 * share), 1.0 - share
    at_left = [1.0 - risen, (n - 1) * share * rest**2]
    at_right = [risen, -(n - 1) * share**2 * rest]
    path += (right.angle - path[-1]) * at_right[0] + (right.slope - slopes[-1]) * at_right[1]
    variance = _variance(left, at_left) + _variance(right, at_right)
    variance += motor.wander(samples) * ((n - 1) * share * rest) ** 3 / 3.0
    return path, variance, left.side + (right.side - left.side) * risen


def _variance(knot: Knot, weights: Sequence[Floats]) -> Floats:
    """Return the variance of weighted sums (n_sample,) of a knot's angle and slope."""
    both = np.stack(weights)
    return np.asarray(np.sum(both * (knot.covariance @ both), axis=0), dtype=np.float64)
