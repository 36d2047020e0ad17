"""The noise of the equations under a model: causes change the masses that noise of the angles is multiplied by.

What one draw of noise, sent the way of the data, leaves under a model tells how it is weighed: first under the
base model, which a missing rotor, load or spring bends, and again under the causes that were accepted. Where that
makes a difference, the search is done once more.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg

from arm.model import Floats
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.rows import Equations

#: Noise is measured in this part of the band, where differentiated angles are all of it.
_FROM = 0.5
#: A filter will not do if along any direction of the joints' torques there is so many times more noise than it
#: takes there to be, for then noise passes for causes; nor if there is so much less. Noise of one angle enters all
#: joints, so where masses couple them there is little along one direction, however much each joint has alone.
_MORE, _LESS = 1.1, 1.0 / 1.5
#: … but a model under which noise is so much larger has masses that make no sense.
_NONSENSE = 1e3
#: No direction of the joints' torques has less noise than this share of the noisiest.
_LEAST = 1e-6


def reweighted(
    equations: Equations, model: Model, x: Floats, motions: Sequence[Motion], noisier: Mapping[int, Motion]
) -> Weighting:
    """Return the filter that makes the noise white under a model.

    Parameters
    ----------
    equations : Equations
        Their filter says how large the torque's own noise is, and how wide the band.
    model : Model
    x : (n_factor,)
    motions : sequence of Motion
    noisier : mapping of int to Motion
        The same with as much noise again, by their numbers.
    """
    used, n_joint = equations.weighting, equations.arm.n_joint
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
    least = _LEAST * max(float(size.max()), 1e-300)
    noise = (axes * np.maximum(size, least)) @ axes.T
    return replace(used, acceleration_noise=noise)


def will_do(used: Weighting, right: Weighting) -> bool:
    """Say whether a filter is near enough to the right one, or what is held to be right makes no sense."""
    ratio = np.concatenate(
        [
            scipy.linalg.eigh(right.covariance(f), used.covariance(f), eigvals_only=True)
            for f in (_FROM * used.band_hz, used.band_hz)
        ]
    )
    return bool(np.all((ratio < _MORE) & (ratio > _LESS)) or np.any(ratio > _NONSENSE))
