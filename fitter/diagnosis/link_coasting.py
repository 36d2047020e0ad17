"""How a link moves while its motor crosses the gap of a backlash.

The motor touches the side towards which it pulls. On its way across it passes on no torque, so the link coasts:
its angle and velocity go on smoothly while the motor's do not. Between the instants at which the motor surely
touched, the link's angle is the cubic that joins its angles and velocities there (Hermite). After a rest, in which
the motor's place in its gap is unknown, the link begins to move at contact, and not before.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_erosion, gaussian_filter1d

from arm.model import Floats
from fitter.diagnosis.least_squares import BLOCK_S, EQUAL_SIGMAS, SIGMAS
from fitter.diagnosis.whitening import LASTS_S

#: The torque's sign is determined behind a Gaussian of this width [s]; within it a contact is not certain.
WIDTH_S = 0.004


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


class End(NamedTuple):
    """Angle and velocity of a link at an end of a crossing [rad], [rad a sample], their covariance, (2, 2)."""

    angle: float
    slope: float
    covariance: Floats


def contact_side(torque: Floats, noise: float, dt_s: float) -> Floats:
    """Return the side that a motor touches, (n_sample,), 0 where it is not sure."""
    width = max(WIDTH_S / dt_s, 0.5)
    smooth = gaussian_filter1d(torque, width)
    least = SIGMAS * noise / np.sqrt(2.0 * np.sqrt(np.pi) * width)
    around = np.ones(2 * round(EQUAL_SIGMAS * width) + 1, dtype=np.bool_)
    forwards, backwards = (binary_erosion(way * smooth > least, around, border_value=True) for way in (1.0, -1.0))
    return forwards.astype(np.float64) - backwards


def coasting(
    angle: Floats,
    torque: Floats,
    noise: tuple[float, float],
    starts: Sequence[int],
    dt_s: float,
    *,
    wanders_s: float = 0.02,
    slope_s: float = 0.03,
    few: int = 5,
    crossing: int = 2,
) -> Coasting:
    """Return how a link coasts while its motor crosses.

    Parameters
    ----------
    angle, torque : (n_sample,)
        Of the motor.
    noise : (float, float)
        Standard deviations of both in a sample.
    starts : sequence of int
        Samples at which some drive was suddenly asked for another torque: what rested, rested till then.
    dt_s : float
    wanders_s : float
        A motor whose torque does not differ significantly from zero for this long may be anywhere in its play;
        after a block's length its link is at rest.
    slope_s : float
        The link's velocity at an end of a crossing is that of a parabola through the angles of so long.
    few : int
        Samples that say whether an angle is still, or how it moves.
    crossing : int
        Samples that a motor takes to cross when nothing holds it.
    """
    shaking, torque_noise = noise
    touching = contact_side(torque, torque_noise, dt_s)
    for at in starts:  # a large jump is brought forward by more
        touching[max(0, at - round(2 * EQUAL_SIGMAS * WIDTH_S / dt_s)) : at] = 0.0
    bridge, variance, side = np.zeros((3, len(angle)))
    sure = np.flatnonzero(touching)
    if not len(sure):
        return Coasting(bridge, variance, side)
    sign = touching[sure]
    side += sign[np.clip(np.searchsorted(sure, np.arange(len(angle)), side="right") - 1, 0, None)]
    window, wanders, rests, still_for = (max(3, round(s / dt_s)) for s in (slope_s, wanders_s, BLOCK_S, LASTS_S))
    away = np.diff(sure)
    leaves = np.flatnonzero((away > wanders) | (np.diff(sign) != 0.0))
    runs = np.concatenate([[0], leaves + 1, [len(sure)]])
    for k, leave in enumerate([-1, *leaves]):
        begin, end = int(sure[leave]) if k else 0, int(sure[leave + 1])
        before, after = sign[leave] if k else 0.0, sign[leave + 1]
        last = min(max(int(sure[runs[k + 1] - 1]), end + few), end + window, len(angle) - 1)
        arrived = _at_end(angle[end : last + 1], few)
        inner = [at for at in starts if begin + few <= at <= end]
        started = [at for at in inner if np.std(angle[max(begin, at - still_for) : at]) < EQUAL_SIGMAS * shaking]
        if started or not k or end - begin > rests:
            start = max(started, default=begin)
            end = max(end, min(start + crossing, len(angle) - 1)) if started else end
            still, start, where, rest = _rest(
                angle, torque, torque_noise, (begin, start, end), still_for, after, crossing
            )
            if k and not started:  # nothing says when it came to rest
                still = max(begin, start - still_for)
            settled = _rising(np.linspace(0.0, 1.0, max(still - begin, 0)))
            bridge[begin:still] = settled * (where - angle[begin:still])
            side[begin:still] = (before or rest) + (rest - (before or rest)) * settled
            bridge[still:start], side[still:start] = where - angle[still:start], rest
            # Where it rests is known by one angle: the one at which it is touched, or a mean.
            variance[begin:start] = 1.0
            left, begin, before = End(where, 0.0, np.diag([1.0, 0.0])), start, rest
        else:
            first = max(min(int(sure[runs[k - 1]]), begin - few), begin - window, 0)
            left = _at_end(angle[first : begin + 1][::-1], few)
            left = left._replace(slope=-left.slope, covariance=left.covariance * [[1.0, -1.0], [-1.0, 1.0]])
        if end > begin:
            share = (np.arange(begin, end + 1) - begin) / (end - begin)
            side[begin : end + 1] = before + (after - before) * _rising(share)
            # The last angle is the motor's, as all behind it are.
            path, scatter = _hermite(share, end - begin, left, arrived._replace(angle=float(angle[end])))
            bridge[begin : end + 1], variance[begin : end + 1] = path - angle[begin : end + 1], scatter
    return Coasting(bridge, variance, side)


def _rest(
    angle: Floats,
    torque: Floats,
    noise: float,
    span: tuple[int, int, int],
    still_for: int,
    after: float,
    crossing: int,
) -> tuple[int, int, float, float]:
    """Return from which sample a link was still, until when, its motor's angle then, and the side it was at.

    ``span`` is when the motor left a side, was asked to start, and touched the side ``after``. A torque, small but
    steady, that friction holds determines the side. Otherwise the motor was within its gap, and the link moves
    when it is touched.
    """
    begin, start, end = span
    still = max(begin, start - still_for)
    mean = float(torque[still:start].mean()) if start > still else 0.0
    if abs(mean) > SIGMAS * noise / np.sqrt(max(start - still, 1)):
        return still, start, float(angle[still:start].mean()), float(np.sign(mean))
    first = begin + int(np.argmax(np.abs(torque[begin : end + 1]) > SIGMAS * noise))
    # `end` lies behind the touch by what was eroded, so no spike of noise long before it is taken for one.
    touch = min(end, max(first, end - round(2 * EQUAL_SIGMAS * WIDTH_S / LASTS_S * still_for)) + crossing)
    return still, touch, float(angle[touch]), after


def _hermite(share: Floats, n: int, left: End, arrived: End) -> tuple[Floats, Floats]:
    """Return the cubic over n samples with values and slopes of its ends, and its variance, (n_share,) each."""
    across, rest = _rising(share), 1.0 - share
    values, variances = np.zeros((2, len(share)))
    for end, weights in (
        (left, [1.0 - across, n * share * rest**2]),
        (arrived, [across, -n * share**2 * rest]),
    ):
        of_end = np.stack(weights)
        values += end.angle * of_end[0] + end.slope * of_end[1]
        variances += np.sum(of_end * (end.covariance @ of_end), axis=0)
    return values, variances


def _rising(share: Floats) -> Floats:
    return np.asarray(share**2 * (3.0 - 2.0 * share), dtype=np.float64)


def _at_end(angles: Floats, few: int) -> End:
    """Return the first of some angles and the slope there: of a parabola, of few of a straight line."""
    order = 2 if len(angles) > 2 * few else min(1, len(angles) - 1)
    powers = np.vander(np.arange(len(angles), dtype=np.float64), order + 1, increasing=True)
    inverse = np.linalg.pinv(powers)
    fitted, covariance = np.zeros(2), np.zeros((2, 2))
    n = min(order + 1, 2)
    fitted[:n] = (inverse @ angles)[:n]
    covariance[:n, :n] = (inverse @ inverse.T)[:n, :n]
    return End(float(fitted[0]), float(fitted[1]), covariance)
