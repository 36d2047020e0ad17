"""The noise of the equations under a model: causes change the masses that noise of the angles is multiplied by.

What one draw of noise, sent the way of the data, leaves under a model tells how it is weighed. What the drive asks
of a joint that rests tells how large the torque may be that holds it: no larger than what was seen to hold it
anywhere. A joint that is asked for 1 N m, and has never been held by more than 0.01, moves at once; unknown
torques of any size next to such a start could do whatever a lag, a limit or a play does to it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.least_squares import PLAINLY, ROUNDED, SIGMAS, TINY
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.rows import Equations
from fitter.diagnosis.whitening import WINDOW_S, Whitening, inner_rests

#: The noise's size is known to a tenth (`whitening`) …
SIZE_KNOWN = 0.1
#: … so no more variance than this multiple of its own is a floor.
KNOWN = (1.0 + SIZE_KNOWN) ** 2
#: Noise is measured in this part of the band, where differentiated angles are all of it.
_FROM = 0.5
#: So many times the largest torque that has held is allowed for, as a standard deviation: more might have held.
_ALLOWED = 2.0


@dataclass(frozen=True)
class Floor:
    """The floor of every joint.

    Attributes
    ----------
    ratio : (n_joint,)
        Variance of what is left, in units of the sensors' noise.
    white : (n_joint,) [N m or N]
        sqrt(D), a sample.
    steep : (n_joint,)
        E.
    """

    ratio: Floats
    white: Floats
    steep: Floats

    @property
    def is_none(self) -> bool:
        """Whether nothing but the sensors' noise is left."""
        return bool(np.all(self.ratio <= KNOWN))

    @property
    def is_plain(self) -> bool:
        """Whether much more is left."""
        return bool(np.any(self.ratio > PLAINLY))


def reweighted(
    equations: Equations,
    used: Weighting,
    model: Model,
    x: Floats,
    motions: Sequence[Motion],
    noisier: Mapping[int, Motion],
) -> Weighting:
    """Return the filter that makes the noise white under a model.

    Parameters
    ----------
    equations : Equations
    used : Weighting
        It says how large the torque's own noise is, and how wide the band.
    model : Model
    x : (n_factor,)
    motions : sequence of Motion
    noisier : mapping of int to Motion
        The same with as much noise again, by their numbers.
    """
    n_joint = equations.arm.n_joint
    total, count = np.zeros((n_joint, n_joint)), 0
    white = np.diag(used.torque_noise**2)
    for motion in motions:
        plain, noisy = (equations.left(model, x, one) for one in (motion, noisier[motion.number]))
        window = np.hanning(len(plain))[:, None]
        f = np.fft.rfftfreq(len(plain), motion.dt_s)
        inside = (f >= _FROM * used.band_hz) & (f <= used.band_hz)
        scale = (2.0 * np.pi * f[inside]) ** 4
        spectrum = np.fft.rfft(window * (noisy - plain), axis=0)[inside]
        spectrum /= np.sqrt(np.sum(window**2) * scale)[:, None]
        total += np.real(spectrum.T @ spectrum.conj()) - white * np.sum(1.0 / scale)
        count += int(np.count_nonzero(inside))
    size, axes = np.linalg.eigh(total / max(count, 1))
    least = np.sqrt(ROUNDED) * max(float(size.max()), TINY)
    found = replace(used, acceleration_noise=(axes * np.maximum(size, least)) @ axes.T)
    return replace(found, holding=holding_sizes(equations, found, model, x, motions))


def holding_sizes(
    equations: Equations, weighting: Whitening, model: Model, x: Floats, motions: Sequence[Motion]
) -> dict[int, Floats]:
    """Return the standard deviation of what may hold each joint, by the motions' numbers.

    It is told by what holds it well inside its rests, where it was seen to stand still for a while: the drive's
    torque less the arm's own. What the model's friction could hold is allowed for in any case, whatever that
    depends on: a joint that has just begun to move is not seen to, and its friction counts already.

    Parameters
    ----------
    equations : Equations
    weighting : Whitening
        By it noise is not taken for what holds a joint.
    model : Model
    x : (n_factor,)
    motions : sequence of Motion

    Returns
    -------
    mapping of int to (n_sample, n_joint) [N m or N]
        inf where nothing tells: a joint never rests for long, and its Coulomb friction was denied.
    """
    largest = np.full(equations.arm.n_joint, np.nan)
    for motion in motions:
        held = equations.left(model, x, motion)
        for j in range(len(largest)):
            for rest in inner_rests(motion.stuck[:, j], motion.dt_s):
                weight = np.hanning(min(rest.stop - rest.start, round(WINDOW_S / motion.dt_s)) + 2)[1:-1]
                weight /= weight.sum()
                seen = np.abs(np.convolve(held[rest, j], weight, "valid"))
                beyond = float(seen.max()) - SIGMAS * weighting.mean_noise(j, weight, motion.dt_s)
                largest[j] = np.fmax(largest[j], max(beyond, 0.0))
    found = {}
    for motion in motions:
        friction = _friction(equations, model, x, motion)
        unseen = np.inf if "fc" in equations.denied else _ALLOWED * friction
        found[motion.number] = _ALLOWED * np.where(np.isnan(largest), unseen, np.fmax(largest, friction))
    return found


def _friction(equations: Equations, model: Model, x: Floats, motion: Motion) -> Floats:
    """Return the friction of joints at rest, if they were about to move either way, (n_sample, n_joint)."""
    coulomb = np.abs(equations.friction(model, x, motion)[:, 1])
    found = np.broadcast_to(coulomb, motion.q.shape)
    if not any(hypothesis.kind.holds for hypothesis in model.hypotheses):
        return found
    ways = (replace(motion, direction=np.where(motion.stuck, way, motion.direction)) for way in (1.0, -1.0))
    forward, backward = (equations.left(model, x, one) for one in ways)
    return np.asarray(np.maximum(found, 0.5 * np.abs(forward - backward)), dtype=np.float64)
