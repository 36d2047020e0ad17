"""The noise of the equations under a model: causes change the masses that noise of the angles is multiplied by.

What one draw of noise, sent the way of the data, leaves under a model tells how it is weighed. What the drive asks
of a joint that rests tells how large the torque may be that holds it: no larger than what was seen to hold it
anywhere. A joint that is asked for 1 N m, and has never been held by more than 0.01, moves at once; unknown
torques of any size next to such a start could do whatever a lag, a limit or a play does to it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Arm, Floats
from fitter.diagnosis.cutoff import BAND_SHARE, noise_of_angles, white_noise
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.least_squares import PLAINLY, ROUNDED, SIGMAS, TINY
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import SAMPLES, Motion
from fitter.diagnosis.weighting import Weighting
from fitter.diagnosis.whitening import (
    WINDOW_S,
    inner_rests,
)

#: A perfect torque or angle has at least the noise of rounding, as a share of its rms.
_LEAST_NOISE = 1e-4


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
    noise = (axes * np.maximum(size, least)) @ axes.T
    return replace(used, acceleration_noise=noise)


def holding_sizes(equations: Equations, model: Model, x: Floats, motions: Sequence[Motion]) -> Floats:
    """Return the standard deviation of what may hold each joint.

    It is told by what holds it well inside its rests, where it was seen to stand still for a while: the drive's
    torque less the arm's own. Coulomb friction is allowed for in any case.

    Parameters
    ----------
    equations : Equations
    model : Model
    x : (n_factor,)
    motions : sequence of Motion

    Returns
    -------
    (n_joint,) [N m or N]
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
                beyond = float(seen.max()) - SIGMAS * equations.weighting.mean_noise(j, weight, motion.dt_s)
                largest[j] = np.fmax(largest[j], max(beyond, 0.0))
    coulomb = np.abs(equations.friction(model, x, motions[0])[:, 1])
    unseen = np.inf if "fc" in equations.denied else _ALLOWED * coulomb
    held = np.where(np.isnan(largest), unseen, np.fmax(largest, coulomb))
    return np.asarray(_ALLOWED * held, dtype=np.float64)


def weighting(arm: Arm, motions: Sequence[Motion]) -> Weighting:
    """Return the filter for a run of which no more is known: every joint turns a mass of one by itself.

    Parameters
    ----------
    arm : Arm
        Its law says how the noise of the angles enters a torque that was not measured.
    motions : sequence of Motion
    """
    angle = noise_of_angles([motion.trial for motion in motions])
    u = np.concatenate([motion.u for motion in motions])
    if all("tau" in motion.trial.whole for motion in motions):
        torque = white_noise([motion.trial.whole["tau"] for motion in motions])
    elif arm.control.kp and motions[0].trial.tau is None:
        torque = np.abs(arm.control.kp) * angle
    else:
        torque = np.zeros(arm.n_joint)
    # What counts is the noise's density; the slower grid has the same with fewer samples.
    thinned = np.sqrt(np.mean([motion.trial.dt_s / motion.dt_s for motion in motions]))
    torque, angle = thinned * torque, thinned * angle
    torque = np.maximum(torque, _LEAST_NOISE * np.maximum(np.sqrt(np.mean(u**2, axis=0)), 1e-9))
    q = np.concatenate([motion.q for motion in motions])
    angle = np.maximum(angle, 1e-9 * np.maximum(np.std(q, axis=0), 1.0))
    acceleration = np.diag(angle**2)
    dt_s = max(motion.dt_s for motion in motions)
    corner = min(*(motion.trial.cutoff_hz for motion in motions), 0.4 / dt_s)
    band = BAND_SHARE * corner
    nothing_told = np.full(arm.n_joint, np.inf)
    return Weighting(torque, acceleration, band, max(1, int(1.0 / (dt_s * 0.5 * SAMPLES * band))), nothing_told)
