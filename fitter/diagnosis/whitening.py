r"""The filter that makes the noise of the equation of motion white.

A joint's row is ``Y p + C c = u``. Its noise is that of the torque, white, and that of the angles differentiated
twice, with a power spectrum

    S(f) = diag(s_u^2) + mean(M diag(s_q^2) M^T) (2 pi f)^4,

a matrix, for the noise of one angle enters the equations of all joints. Both sides pass the zero-phase filter
``L^-1`` with ``L L^T = S``, and what lies beyond the columns' corner is cut off. The residual of the true model is
then white with variance 1, so that plain least squares is all but maximum likelihood, and no frequency is thrown
away that tells something. A slower grid holds all that is left.
"""

from dataclasses import dataclass, field

import numpy as np
import scipy.fft

from arm.model import Floats
from fitter.diagnosis.unknown_torque import end_weight

#: The band falls off, as a squared sine, over this share of it: 3/8 of the noise in there pass.
_EDGE = 0.2


@dataclass(frozen=True)
class Whitening:
    """The filter that makes noise white.

    Attributes
    ----------
    torque_noise : (n_joint,)
        White part of the noise, as rms a sample.
    acceleration_noise : (n_joint, n_joint)
        Factor of ``(2 pi f)^4`` in the noise's covariance a sample.
    band_hz : float
    stride : int
        Every so manieth sample is kept.
    """

    torque_noise: Floats
    acceleration_noise: Floats
    band_hz: float
    stride: int
    _windows: dict[tuple[int, float], tuple[Floats, Floats, int]] = field(
        default_factory=dict, init=False, repr=False
    )

    @property
    def seen_hz(self) -> float:
        """Where the noise of differentiated angles outgrows that of the torque, at the last joint to."""
        rate = np.sqrt(np.max(self.torque_noise / np.sqrt(np.maximum(np.diag(self.acceleration_noise), 1e-300))))
        return float(np.clip(rate / (2.0 * np.pi), 1.0, self.band_hz))

    def covariance(self, f: float) -> Floats:
        """Return the noise's covariance a sample at a frequency [Hz], (n_joint, n_joint)."""
        return np.diag(self.torque_noise**2) + self.acceleration_noise * (2.0 * np.pi * f) ** 4

    def mean_noise(self, joint: int, weight: Floats, dt_s: float) -> float:
        """Return the noise of a weighted mean of a joint's unfiltered equation, rms [N m or N].

        The angles' noise enters it by the weight's second derivative, for a mean of differences is one of ends.

        Parameters
        ----------
        joint : int
        weight : (n_sample,)
        dt_s : float
        """
        bend = np.diff(np.pad(weight, 2), 2) / dt_s**2
        white, angles = self.torque_noise[joint], self.acceleration_noise[joint, joint]
        return float(np.sqrt(white**2 * (weight @ weight) + angles * (bend @ bend)))

    def white(self, rows: Floats, dt_s: float, joints: slice = slice(None)) -> Floats:
        """Return rows of some joints, filtered and on the slower grid, (n_slower, n_joint, …)."""
        n, n_row, rest = len(rows), rows.shape[1], rows.shape[2:]
        gain, weight, slower = self._window(n, dt_s)
        flat = rows.reshape(n, -1) * weight
        kept = len(gain)  # nothing is left beyond the band
        part = scipy.fft.rfft(flat, slower * self.stride, axis=0)[:kept].view(np.float64).reshape(kept, n_row, -1)
        passed = (gain[:, :, joints] @ part).reshape(kept, -1).view(np.complex128)
        white = scipy.fft.irfft(passed, slower, axis=0)[: -(-n // self.stride)]
        return np.asarray(white, dtype=np.float64).reshape(len(white), gain.shape[1], *rest)

    def _window(self, n: int, dt_s: float) -> tuple[Floats, Floats, int]:
        """Return gains (n_frequency, n_joint, n_joint), weights (n, 1) and the size of the slower grid."""
        key = n, dt_s
        if key not in self._windows:
            slower = scipy.fft.next_fast_len(-(-(n + round(1.0 / dt_s)) // self.stride), real=True)
            f = scipy.fft.rfftfreq(slower * self.stride, dt_s)
            band = self.band(f)
            f, band = f[band > 0.0], band[band > 0.0]
            noise = np.diag(self.torque_noise**2) + self.acceleration_noise * (2 * np.pi * f[:, None, None]) ** 4
            root = np.linalg.inv(np.linalg.cholesky(noise))
            gain = root * (band / np.sqrt(self.stride))[:, None, None]
            self._windows[key] = gain, end_weight(n, dt_s)[:, None], slower
        return self._windows[key]

    def band(self, f: Floats) -> Floats:
        """Return the share of an amplitude that passes at some frequencies [Hz]."""
        edge = np.clip((self.band_hz - f) / (_EDGE * self.band_hz), 0.0, 1.0)
        return np.asarray(np.sin(np.pi / 2.0 * edge) ** 2, dtype=np.float64)

    def n_told(self, n_slower: int, dt_s: float) -> float:
        """Return how many independent numbers so many samples of the slower grid hold."""
        return 2.0 * self.stride * dt_s * (1.0 - 0.625 * _EDGE) * self.band_hz * n_slower
