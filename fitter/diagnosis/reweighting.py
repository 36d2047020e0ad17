"""The noise of the equations under a model: causes change the masses that noise of the angles is multiplied by.

What one draw of noise, sent the way of the data, leaves under a model tells how it is weighed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.rows import Equations

#: Noise is measured in this part of the band, where differentiated angles are all of it.
_FROM = 0.5
#: No direction of the joints' torques has less noise than this share of the noisiest.
_LEAST = 1e-6


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
    least = _LEAST * max(float(size.max()), 1e-300)
    noise = (axes * np.maximum(size, least)) @ axes.T
    return replace(used, acceleration_noise=noise)
