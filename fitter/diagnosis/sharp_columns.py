"""What begins or ends between two samples, as the columns of a motion have it: behind their filter."""

from collections.abc import Callable

import numpy as np

from arm.model import Floats
from fitter.data.derivatives import HIGHEST_CORNER, lowpass, settling_samples
from fitter.diagnosis.motion import Motion


def behind_filter(motion: Motion, area: Callable[[Floats], Floats], within: tuple[float, float]) -> Floats:
    """Return a function of time on a motion's grid, low-passed as its columns were, (n_sample,).

    Parameters
    ----------
    motion : Motion
    area : callable
        The function's integral from any instant of the run's clock (n,) [s] on: its ends need be at no sample.
    within : (float, float) [s]
        Outside of it the function is constant: a motion that is far from it is spared the filter.
    """
    trial, step = motion.trial, round(motion.dt_s / motion.trial.dt_s)
    n, dt_s = len(trial.t), trial.dt_s
    reach_s = dt_s * (1 + settling_samples(dt_s, trial.cutoff_hz))
    first_s, last_s = motion.t[0] - reach_s, motion.t[0] + n * dt_s + reach_s
    if within[1] < first_s or within[0] > last_s:
        middle = motion.t + np.array([[-0.5], [0.5]]) * dt_s
        return np.asarray(np.diff(area(middle), axis=0)[0] / dt_s)
    at = motion.t[0] + dt_s * np.arange(-trial.trimmed - 0.5, n + trial.trimmed + 1.0)
    means = lowpass(np.diff(area(at)) / dt_s, dt_s, trial.cutoff_hz)
    if trial.cutoff_hz * dt_s < HIGHEST_CORNER:  # a mean over a step is off by a part of the bend
        means[1:-1] -= np.diff(means, 2) / 24.0
    return np.asarray(means[trial.trimmed : trial.trimmed + n][::step], dtype=np.float64)
