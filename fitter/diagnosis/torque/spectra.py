r"""Rows of the torque equation in the frequency domain.

A residual of the equation of motion is stationary noise to a good approximation, so its Fourier coefficients are
independent, each with the noise's spectral density as its covariance (Whittle 1953). Regression rows, target and
nuisance shapes of a motion are therefore kept as coefficients up to the band's end,

.. math:: X(f_k) = \sqrt{2/N} \sum_t w_t x_t e^{-2 \pi i f_k t},

scaled such that white noise of variance s^2 a sample has real and imaginary parts of variance s^2 each.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.unknown_torque import end_weight

Complexes = NDArray[np.complex128]

#: The band ends at this part of the columns' corner, up to which their Butterworth filter of order 4, run both
#: ways, passes 98 % of an amplitude: 1 / (1 + 0.6^8).
BAND_SHARE = 0.6


@dataclass(frozen=True)
class Spectra:
    """The Fourier coefficients of one motion's rows.

    Attributes
    ----------
    n : int
        Samples of the motion.
    dt_s : float
        Their step [s].
    band_hz : float
        Coefficients beyond it are left out [Hz].
    """

    n: int
    dt_s: float
    band_hz: float

    @cached_property
    def size(self) -> int:
        """Length of the transform."""
        return int(scipy.fft.next_fast_len(self.n, real=True))

    @cached_property
    def f(self) -> Floats:
        """Frequencies, (n_frequency,) [Hz]."""
        every = scipy.fft.rfftfreq(self.size, self.dt_s)
        return np.asarray(every[every <= self.band_hz], dtype=np.float64)

    @cached_property
    def weight(self) -> Floats:
        """The window, (n,): it rises at one end and falls at the other."""
        return end_weight(self.n, self.dt_s)

    @cached_property
    def _scale(self) -> Floats:
        scale = np.full(len(self.f), np.sqrt(2.0 / self.size))
        scale[0] = np.sqrt(1.0 / self.size)
        return scale

    def of(self, rows: Floats) -> Complexes:
        """Return the coefficients of rows (n, n_joint, k), (n_frequency, n_joint, k) complex."""
        flat = rows.reshape(self.n, -1) * self.weight[:, None]
        found = scipy.fft.rfft(flat, self.size, axis=0)[: len(self.f)] * self._scale[:, None]
        return np.asarray(found.reshape(len(self.f), *rows.shape[1:]), dtype=np.complex128)

    def in_time(self, rows: Complexes) -> Floats:
        """Return coefficients (n_frequency, …) as time series of the same sum of squares, (size, …)."""
        flat = rows.reshape(len(self.f), -1) * np.sqrt(self.size / 2.0)
        flat[0] *= np.sqrt(2.0)
        whole = scipy.fft.irfft(flat, self.size, axis=0)
        return np.asarray(whole.reshape(self.size, *rows.shape[1:]), dtype=np.float64)


def spectra_of(motion: Motion, band_hz: float) -> Spectra:
    """Return how rows of a motion are transformed."""
    return Spectra(len(motion.t), motion.dt_s, band_hz)
