"""Up to which frequency a person's ground force is worth fitting: where motion and force still agree.

A motion from markers has noise that twice differentiating makes large, and in the regressor it draws masses to
zero. Force and motion are measured apart: what the arm's own masses predict of the force stands out from that
noise where it is like the measured one.
"""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.data.bandwidth import BINS_A_BAND, SIGNAL_TO_NOISE, WIDER
from fitter.ground.frequency_rows import frequency_rows
from fitter.ground.ground_trial import GroundTrial

#: No corner is lower: postures alone change as fast [Hz].
_SLOWEST_HZ = 1.0
#: Nor higher: hardly any power of a person's ground force is left but that of heel strikes (Winter 2009) [Hz].
FASTEST_HZ = 6.0


def fit_corner_hz(trials: Sequence[GroundTrial], theta: Floats) -> float:
    """Return the highest frequency at which the force's power is ten times that of its misfit [Hz].

    Parameters
    ----------
    trials : sequence of GroundTrial
        The learning ones.
    theta : (10 n_body,)
        The arm's own bodies; that they are the table's only makes the corner lower.
    """
    misfit = [(trial.wrench - trial.Y @ theta)[:, :, None] for trial in trials]
    rows = frequency_rows(misfit, [trial.wrench for trial in trials], [trial.dt_s for trial in trials], FASTEST_HZ)
    changes = rows.hz > 0.0
    hz, force = rows.hz[changes], np.sum(rows.w[changes, :3] ** 2, axis=1)
    noise = np.sum(rows.Y[changes, :3, 0] ** 2, axis=1)
    edge, corner = max(BINS_A_BAND * float(hz.min()), float(hz.min())), _SLOWEST_HZ
    while edge < FASTEST_HZ:
        band = (hz >= edge) & (hz < WIDER * edge)
        if band.any() and force[band].sum() >= SIGNAL_TO_NOISE * noise[band].sum():
            corner = max(corner, min(WIDER * edge, FASTEST_HZ))
        edge *= WIDER
    return corner
