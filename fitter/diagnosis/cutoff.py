"""Up to which frequency the columns of a run are looked at: as far as most of its motion goes, and no lower.

Above some 30 Hz hardly any motion is left, and the noise of an angle that was differentiated twice is large enough
to bend the regressors. A loop that is late by a few milliseconds may swing nearly as fast, and do nothing else.

So far the noise must be understood. Where the angles' noise is not as white as their third differences have it
(they were filtered, or resampled, or the mount shakes), no more is looked at than what stands out of it. And where
a measured torque is mostly noise, whoever reads the verdict has to know.
"""

from collections.abc import Sequence

import numpy as np
import scipy

from arm.model import Arm, Floats
from fitter.data.resample import Uniform
from fitter.data.trial import Trial
from fitter.data.trial_filter import choose_cutoff_hz
from fitter.diagnosis.least_squares import CLEAR_RATIO, SIGMAS
from fitter.diagnosis.motion import SAMPLES

#: The band ends at this ratio to the columns' cutoff frequency, where their filter still passes all.
BAND_SHARE = 0.6


#: Columns are cut off at this frequency [Hz], or higher where motion is quicker: arms move below 10 Hz, and
#: overtones of friction and gravity go a little further.
CORNER_HZ = 30.0


def corner_hz(grids: Sequence[Uniform], *, overtones: float = 3.0, share: float = 0.9) -> float:
    """Return the corner that the columns of a run are cut off at [Hz].

    Parameters
    ----------
    grids : sequence of Uniform
        Their angles ``q``.
    overtones : float
        Quick motion is looked at up to this multiple of the frequency below which most of it lies.
    share : float
        Of the power of a joint's velocity that is most of it.
    """
    highest = 1.0 / (SAMPLES * max(grid.dt_s for grid in grids))
    quick = _quick_hz(grids, highest, share)
    widest = float(min(max(CORNER_HZ, overtones * quick), highest))
    standing_out = choose_cutoff_hz(grids)
    if standing_out >= widest or _is_white(grids, standing_out, widest):
        return widest
    return float(min(standing_out / BAND_SHARE, widest))


def _is_white(grids: Sequence[Uniform], low_hz: float, high_hz: float, parts: int = 10) -> bool:
    """Say whether the noise of the angles between two frequencies is as large as their third differences imply.

    It is that of the quietest of some parts of the band: motion may be in the others.
    """
    angles = [grid.measured.columns["q"] for grid in grids]
    noise = np.maximum(white_noise(angles), np.finfo(np.float64).tiny)
    edges = np.linspace(low_hz, high_hz, parts + 1)
    power, count = np.zeros((parts, len(noise))), np.zeros(parts)
    for grid, q in zip(grids, angles, strict=True):
        window = np.hanning(len(q))[:, None]
        own = np.abs(np.fft.rfft(window * (q - q.mean(axis=0)), axis=0)) ** 2 / np.sum(window**2)
        at = np.searchsorted(edges, np.fft.rfftfreq(len(q), grid.dt_s)) - 1
        for part in range(parts):
            power[part] += own[at == part].sum(axis=0)
            count[part] += np.count_nonzero(at == part)
    seen = count > 0.0
    least = np.min(power[seen] / count[seen, None], axis=0)
    return bool(np.all(least < CLEAR_RATIO * noise**2))


def _quick_hz(grids: Sequence[Uniform], highest: float, share: float) -> float:
    """Return the frequency below which most of the quickest joint's speed squared lies, noise taken off."""
    angles = [grid.measured.columns["q"] for grid in grids]
    noise = white_noise(angles)
    f = np.linspace(0.0, highest, 400)
    power = np.zeros((len(f), len(noise)))
    own = np.zeros_like(power)
    for grid, q in zip(grids, angles, strict=True):
        steps = np.diff(q, axis=0)
        at, one = np.fft.rfftfreq(len(steps), grid.dt_s), np.abs(np.fft.rfft(steps, axis=0)) ** 2
        total: Floats = np.cumsum(one, axis=0)
        white = np.cumsum(4.0 * np.sin(np.pi * at * grid.dt_s) ** 2) * len(steps)
        power += np.stack([np.interp(f, at, column) for column in total.T], axis=1)
        own += np.interp(f, at, white)[:, None] * noise**2
    moves = power[-1] > SIGMAS**2 * own[-1]
    quick = [f[np.argmax(power[:, j] - own[:, j] > share * (power - own)[-1, j])] for j in np.flatnonzero(moves)]
    return float(max(quick, default=0.0))


def chatter(arm: Arm, trials: Sequence[Trial]) -> list[str]:
    """Return a sentence for every joint whose measured torque changes from sample to sample as noise does.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
    """
    measured = [trial.whole["tau"] for trial in trials if "tau" in trial.whole]
    if not measured:
        return []
    white = white_noise(measured)
    size = np.sqrt(np.mean(np.concatenate(measured) ** 2, axis=0))
    return [
        f"the torque at joint {j + 1} changes from sample to sample like noise ({white[j]:.3g} {unit} of "
        f"{size[j]:.3g} {unit} rms): smaller effects are not identifiable; a chattering drive looks the same"
        for j, unit in enumerate("N m" if joint.type == "revolute" else "N" for joint in arm.joints)
        if CLEAR_RATIO * white[j] > size[j] > 0.0
    ]


def noise_of_angles(trials: Sequence[Trial]) -> Floats:
    """Return the rms of the white noise in the measured angles, (n_joint,) [rad or m]."""
    return white_noise([trial.whole.get("q", trial.q) for trial in trials])


def white_noise(columns: Sequence[Floats]) -> Floats:
    """Return the rms of what is white in some columns: that of their third differences, robustly.

    Motion has next to nothing in a third difference at these rates; it enlarges white noise by sqrt(20). A column
    most of whose samples repeat those before has none: a coarse step hides it, and errors are uniform within that.
    """
    third = np.concatenate([np.diff(values, 3, axis=0) for values in columns])
    deviation = np.median(np.abs(third), axis=0) / scipy.special.ndtri(0.75) / np.sqrt(20.0)
    for j in np.flatnonzero(deviation == 0.0):
        steps = np.concatenate([np.abs(np.diff(values[:, j])) for values in columns])
        if np.any(steps):
            deviation[j] = np.median(steps[steps > 0.0]) / np.sqrt(12.0)
    return np.asarray(deviation, dtype=np.float64)
