"""Trials filtered less than a plain fit needs."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fitter.data.derived_trial import derive
from fitter.data.motions import Measured
from fitter.data.resample import Uniform
from fitter.data.trial import Trial

#: Factor of the filter's corner with instrumental variables: noise in the columns does not bias these, a filter of
#: products does. Of 1, 2 and 3 the best on the standard bench under law (5) with 0.2, 1 and 3 % of noise.
CORNER_FACTOR = 2.0


def refiltered(trials: Sequence[Trial]) -> list[Trial]:
    """Return trials whose derivatives were found behind a filter with twice the corner.

    Parameters
    ----------
    trials : sequence of Trial
        Those that were never filtered stay as they are.
    """
    return [wider(trial, CORNER_FACTOR) for trial in trials]


def wider(trial: Trial, factor: float) -> Trial:
    """Return a trial whose derivatives were found behind a filter with a multiple of the corner.

    One that was never filtered stays as it is.
    """
    if not trial.whole or not np.isfinite(trial.cutoff_hz):
        return trial
    t = np.arange(len(trial.whole["q"]), dtype=np.float64) * trial.dt_s
    measured = Measured(trial.name, trial.name, 0, t, dict(trial.whole))
    on_grid = Uniform(measured, trial.dt_s, trial.began_s - trial.trimmed * trial.dt_s)
    found = derive(on_grid, factor * trial.cutoff_hz, factor * trial.band_hz)
    return replace(found, role=trial.role, number=trial.number)
