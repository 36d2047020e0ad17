"""The low-pass filter of trials: its corner, from the spectra of a set, and the ends that it makes unusable."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fitter.data.bandwidth import Signal, motion_edge_hz
from fitter.data.derivatives import lowpass, settling_samples
from fitter.data.resample import Uniform
from fitter.data.trial import Floats, Trial
from limbcal.note import Note

#: Corner of derived columns in units of the edge of the motion's band, so that nothing of the motion is lost.
COLUMN_CORNER = 1.5
#: Corner of a fit in units of that of the columns, two thirds of the band's edge: hardly any noise passes.
FIT_CORNER = 2.0 / 3.0 / COLUMN_CORNER
#: Largest share of a trial that is trimmed at each end; its inverse, the fewest periods of a corner in a trial.
TRIM_SHARE = 0.1


def choose_cutoff_hz(motions: Sequence[Uniform]) -> float:
    """Return the corner [Hz] of a filter that keeps all motion that stands out from noise, or infinity."""
    edge = motion_edge_hz([_signal(motion) for motion in motions])
    if edge is None:
        return np.inf
    usual_s = float(np.median([len(motion.measured.t) * motion.dt_s for motion in motions]))
    return max(COLUMN_CORNER * edge, 1.0 / (TRIM_SHARE * usual_s))


def lowpass_trial(trial: Trial, cutoff_hz: float) -> Trial:
    """Return a trial all of whose columns passed one zero-phase filter, without the ends that rest on a guess.

    Parameters
    ----------
    trial : Trial
        What to filter.
    cutoff_hz : float
        Corner frequency.

    Returns
    -------
    Trial
        Its time starts at 0 again; its `lowpass` does nothing more.
    """
    trim = trimmed_samples(len(trial.t), trial.dt_s, cutoff_hz)
    inner = slice(trim, len(trial.t) - trim)

    def filtered(values: Floats | None) -> Floats | None:
        return None if values is None else lowpass(values, trial.dt_s, cutoff_hz)[inner]

    return replace(
        trial,
        t=trial.t[: len(trial.t) - 2 * trim],
        q=lowpass(trial.q, trial.dt_s, cutoff_hz)[inner],
        dq=lowpass(trial.dq, trial.dt_s, cutoff_hz)[inner],
        ddq=lowpass(trial.ddq, trial.dt_s, cutoff_hz)[inner],
        tau=filtered(trial.tau),
        ref=filtered(trial.ref),
        ref_filtered=filtered(trial.ref_filtered),
        tip=filtered(trial.tip),
        points=filtered(trial.points),
        tau_measured=None if trial.tau_measured is None else trial.tau_measured[inner],
        contradicted=None if trial.contradicted is None else trial.contradicted[inner],
        drives=None if trial.drives is None else trial.drives.rows(inner),
        trimmed=trial.trimmed + trim,
        began_s=trial.began_s + trim * trial.dt_s,
        cutoff_hz=np.inf,
        band_hz=np.inf,
        notes=(*trial.notes, Note("filtered", f"all columns low-passed at {cutoff_hz:.4g} Hz (zero phase)")),
    )


def trimmed_samples(n: int, dt_s: float, cutoff_hz: float) -> int:
    """Return how many samples at each end of n are trimmed: those in which the filter settles."""
    return min(settling_samples(dt_s, cutoff_hz), int(TRIM_SHARE * n))


def _signal(motion: Uniform) -> Signal:
    """Return the column that is nearest to an acceleration."""
    columns = motion.measured.columns
    for missing, name in enumerate(("ddq", "dq")):
        if name in columns:
            return Signal(columns[name], motion.dt_s, missing)
    return Signal(columns["q"], motion.dt_s, 2)
