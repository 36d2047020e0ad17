"""The six base equations of a trial as coefficients of a cosine transform, up to the fit's corner.

What the model leaves is no white noise: it lasts as long as a posture does. Cosine coefficients of a stationary
residual are nearly independent of one another, each with the residual's power at its frequency, so that slow
errors count as few observations and not as many samples. The transform is linear and cuts both sides of the
equation at one frequency: it is the filter too. Its even continuation makes no jump where a trial ends in another
posture than it began in.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from arm.model import Floats

#: Rows of the base's equations: three forces, then three moments.
N_ROW = 6
#: From one band of the spectrum to the next, and the least coefficients in each: power known to a quarter.
_WIDER, _LEAST = 2.0, 16


@dataclass(frozen=True)
class FrequencyRows:
    """The equations of several trials.

    Attributes
    ----------
    Y : (n_coefficient, 6, n_column)
    w : (n_coefficient, 6)
    hz : (n_coefficient,)
    trial : (n_coefficient,) int
    """

    Y: Floats
    w: Floats
    hz: Floats
    trial: NDArray[np.intp]

    def bands(self) -> NDArray[np.intp]:
        """Return the band that each coefficient is in, (n_coefficient,), from 0 at the lowest frequencies."""
        order = np.argsort(self.hz, kind="stable")
        band = np.zeros(len(order), dtype=np.intp)
        first, now, begins = 0, 0, 0.0
        for place, k in enumerate(order.tolist()):
            if place - first >= _LEAST and self.hz[k] > _WIDER * begins and len(order) - place >= _LEAST:
                first, now, begins = place, now + 1, float(self.hz[k])
            band[k] = now
            if place == first + _LEAST - 1 and now == 0:
                begins = float(self.hz[k])
        return band


def mean_by_band(band: NDArray[np.intp], squares: Floats) -> Floats:
    """Return the mean of numbers of coefficients, (n_coefficient, 6), over each of their bands, (n_band, 6)."""
    total = np.zeros((int(band.max()) + 1, N_ROW))
    np.add.at(total, band, squares)
    return np.asarray(total / np.bincount(band)[:, None])


def frequency_rows(
    Y: Sequence[Floats], w: Sequence[Floats], dt_s: Sequence[float], band_hz: float
) -> FrequencyRows:
    """Transform the equations of trials.

    Parameters
    ----------
    Y : sequence of (n_sample, 6, n_column)
    w : sequence of (n_sample, 6)
    dt_s : sequence of float
    band_hz : float
        What is faster is left out.
    """
    parts = []
    for k, (one, wrench, dt) in enumerate(zip(Y, w, dt_s, strict=True)):
        hz = np.arange(len(wrench)) / (2.0 * len(wrench) * dt)
        kept = int(np.searchsorted(hz, band_hz, side="right"))
        parts.append(
            FrequencyRows(
                scipy.fft.dct(one, axis=0, norm="ortho")[:kept],
                scipy.fft.dct(wrench, axis=0, norm="ortho")[:kept],
                hz[:kept],
                np.full(kept, k),
            )
        )
    return FrequencyRows(
        np.concatenate([p.Y for p in parts]),
        np.concatenate([p.w for p in parts]),
        np.concatenate([p.hz for p in parts]),
        np.concatenate([p.trial for p in parts]),
    )
