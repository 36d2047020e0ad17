"""The frequencies at which a base may move.

What is slower than a trial cannot be told from an arm that rests at another angle, so each trial's own trend is
left out.
"""

from dataclasses import replace

import numpy as np
from scipy.signal import detrend, find_peaks

from arm.model import Floats
from fitter.diagnosis.sensors.fit import Fitted, Trials

#: A base that moves more slowly looks like one that is not level [Hz].
_LOWEST_HZ = 0.1
_PEAKS = 3
#: Grid points a natural step of the spectrum.
_FINER = 4


def base_frequencies(trials: Trials, free: Fitted) -> list[float]:
    """Return the frequencies [Hz] of the highest peaks in a base's acceleration.

    Parameters
    ----------
    trials : Trials
    free : Fitted
        With the motions of a base that may move in any way.
    """
    times, base = [], []
    hypothesis = replace(free.hypothesis, free_base=False)
    for number in range(trials.n_learn):
        at = trials.linearised(number, hypothesis, free.motions[number])
        felt, unit = at.from_base() * at.weight[..., None], at.residual * at.weight
        normal = np.einsum("kcx,kcy->kxy", felt, felt) + 1e-9 * np.eye(3)
        felt_most = np.linalg.solve(normal, np.einsum("kcx,kc->kx", felt, unit)[..., None])[..., 0]
        base.append(detrend(felt_most, axis=0))
        times.append(at.trial.t)
    t, a, dt = np.concatenate(times), np.concatenate(base), trials.trials[0].dt_s
    place = np.round((t - t[0]) / dt).astype(int)
    even: Floats = np.zeros((int(place[-1]) + 1, 3))
    even[place] = a
    n = _FINER * len(even)
    power = (np.abs(np.fft.rfft(even, n=n, axis=0)) ** 2).sum(axis=1)
    frequency = np.fft.rfftfreq(n, dt)
    power[frequency < _LOWEST_HZ] = 0.0
    peaks, _ = find_peaks(power, distance=4 * _FINER)
    highest = peaks[np.argsort(-power[peaks])][:_PEAKS]
    return [float(frequency[peak]) for peak in highest]
