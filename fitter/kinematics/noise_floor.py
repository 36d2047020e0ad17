"""White noise of joint angles, where they are measured so often that their motion is smooth.

Motion fills the low frequencies of an angle's spectrum and noise all of them alike. So the level of the two
highest octaves is that of the noise, if it is flat there. But samples that were taken one by one, each
somewhere else, have a flat spectrum too. What distinguishes the two is the tip: it follows a motion however
fast, and knows nothing of an error of the angles.
"""

from collections.abc import Sequence
from math import comb

import numpy as np
import scipy

from arm.model import Floats
from fitter.data.trial import Trial
from fitter.kinematics.tip_basis import basis

#: Noise below this [rad or m] attenuates nothing that can be seen: half its square is less than a millionth.
NEGLIGIBLE = 1e-3
#: A spectrum is flat where its levels are alike to within this and five standard errors.
_FLAT = 0.1
#: The tip follows if more than this fraction of its fast part is explained by that of the angles.
_FOLLOWS = 0.02
#: With too few samples chance explains more than this fraction: then the tip may well follow.
_BY_CHANCE = 0.1
#: Differences of this order are left to look at of what is fast.
_ORDER = 6
_FEWEST = 64
#: Samples that the tip is compared on.
_COMPARED = 20_000


def noise_floor(revolute: tuple[bool, ...], trials: Sequence[Trial]) -> Floats | None:
    """Return the standard deviation of every angle's noise, or None where the motion is not smooth enough.

    Parameters
    ----------
    revolute : (n_joint,) bool
    trials : sequence of Trial
        With a tip, on uniform grids.

    Returns
    -------
    (n_joint,) [rad or m], or None
    """
    long_enough = [trial for trial in trials if len(trial.q) >= _FEWEST]
    if not long_enough:
        return None
    weight = np.array([len(trial.q) for trial in long_enough], dtype=float)
    levels = np.average([_levels(trial.q) for trial in long_enough], axis=0, weights=weight)  # (3, n_joint)
    level = levels.mean(axis=0)
    noise = np.sqrt(level)
    if np.all(noise < NEGLIGIBLE):
        return np.asarray(noise, dtype=np.float64)
    loud = noise >= NEGLIGIBLE
    scatter = np.sqrt(2.0 * np.pi / (weight.sum() / 4.0))  # of the ratio of two medians of a quarter of all lines
    if np.any(np.ptp(levels, axis=0)[loud] > (_FLAT + 5.0 * scatter) * level[loud]):
        return None
    return None if _tip_follows(revolute, long_enough) else np.asarray(noise, dtype=np.float64)


def _levels(q: Floats) -> Floats:
    """Return the variance of white noise as strong as the spectrum in its upper bands, (3, n_joint)."""
    window = scipy.signal.windows.hann(len(q), sym=False)[:, None]
    frequency = np.fft.rfftfreq(len(q))
    power = 2.0 * np.abs(np.fft.rfft(window * scipy.signal.detrend(q, axis=0), axis=0)) ** 2 / np.sum(window**2)
    # A line of white noise is distributed exponentially: its mean is its median over log 2. One-sided
    # densities of a rate of one hold the variance in half a unit of frequency.
    bands = ((0.125, 0.25), (0.25, 0.375), (0.375, 0.5))
    lines = [power[(frequency > low) & (frequency < high)] for low, high in bands]
    return np.array([np.median(band, axis=0) / (2.0 * np.log(2.0)) for band in lines])


def _tip_follows(revolute: tuple[bool, ...], trials: Sequence[Trial]) -> bool:
    """Return whether the tip's fast motion is that of the angles."""
    explained, whole, n_column, n_row = 0.0, 0.0, 0, 0
    for trial in trials:
        first = slice(0, max(_FEWEST, _COMPARED * len(trial.q) // sum(len(other.q) for other in trials)))
        phi = np.diff(basis(revolute, trial.q[first])[:, 1:], _ORDER, axis=0)
        tip = np.diff(np.asarray(trial.tip)[first], _ORDER, axis=0)
        axes, size, _ = np.linalg.svd(phi, full_matrices=False)
        axes = axes[:, size > 1e-6 * size[0]]
        explained += float(np.sum((axes.T @ tip) ** 2))
        whole += float(np.sum(tip**2))
        n_column, n_row = n_column + axes.shape[1], n_row + len(tip)
    # The squared correlations of differences of order k with their neighbours add up to C(4k, 2k) / C(2k, k)^2.
    by_chance = comb(4 * _ORDER, 2 * _ORDER) / comb(2 * _ORDER, _ORDER) ** 2 * n_column / n_row
    return by_chance > _BY_CHANCE or explained > (_FOLLOWS + 2.0 * by_chance) * whole
