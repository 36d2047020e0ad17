"""How noisy the readings are, from the readings themselves."""

from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled

#: Nobody's accelerometer is quieter than ten microgees, and nobody's arm more rigid [m/s^2 per root Hz]. A filter
#: that believes more takes what it leaves out of a motion, such as curvature in its slopes, for information.
_FINEST = 1e-4
#: Nor is a gyroscope of a chip quieter than a thousandth of a degree a second and root Hz [rad/s per root Hz].
_FINEST_RATE = 1.75e-5
#: Cells in which readings are judged, at the most, and which fraction of them, the calmest, counts; conventions.
_CELLS, _CALM = 400, 0.25
#: A reading's variance shows twentyfold in third differences, which know hardly anything of a motion.
_THIRD = 20.0


@dataclass(frozen=True)
class Noise:
    """Noise of each channel; arrays are (n_channel,) [(m/s^2)^2 or (rad/s)^2].

    Attributes
    ----------
    variance : white noise of one sample
    rounding : what the converter hides from every reading alike while nothing moves
    least : float or (n_channel,)
        Below which the variance of one sample is not believed.
    """

    variance: Floats
    rounding: Floats
    least: Floats | float = 0.0

    def of_mean(self, n_samples: int) -> Floats:
        """Return the variance of a mean of ``n_samples``."""
        return np.maximum(self.variance, self.least) / n_samples + self.rounding

    def parts_of_mean(self, n_samples: int) -> Floats:
        """Return the variance of a mean of ``n_samples`` in its two parts, white noise and rounding, (2, n)."""
        return np.stack([np.maximum(self.variance, self.least) / n_samples, self.rounding])


def noise_of(readings: Floats, rate_hz: float, n_gyro: int = 0) -> Noise:
    r"""Measure the noise of readings, (n, n_channel), n at least four; the last ``n_gyro`` are of gyroscopes.

    Third differences are taken in cells, and the calmest quarter of the cells counts, so a motion that is slow
    against the sampling rate does not show. A converter of step s that is fed noise of standard deviation
    :math:`\sigma` hides :math:`s^2/12\; e^{-4\pi^2\sigma^2/s^2}` from a mean however long, which is nothing from
    half a step of noise on (dither; B. Widrow, I. Kollar, *Quantization Noise*, 2008, ch. 4).
    """
    n = len(readings)
    size = n if n < 64 else min(64, n // 4)
    begins = np.linspace(0, n - size, min(_CELLS, n // size)).astype(int)
    cells = np.stack([np.diff(readings[begin : begin + size], n=3, axis=0) for begin in begins])
    variances = (cells**2).mean(axis=1) / _THIRD
    calm = np.sort(variances, axis=0)[: max(1, int(_CALM * len(begins)))]
    # The calmest quarter of equal cells lies below their mean by the spread that a cell's variance has.
    spread = np.sqrt(4.6 / (size - 3))  # third differences are correlated: 2.31 times that of white ones
    variance = calm.mean(axis=0) / (1.0 - 1.27 * spread if len(begins) >= 4 else 1.0)
    n_accelerometer = readings.shape[1] - n_gyro
    finest = np.repeat([_FINEST, _FINEST_RATE], [n_accelerometer, n_gyro])
    rounding = _rounding(variance, step_of(readings[: 64 * _CELLS]), n_accelerometer)
    return Noise(variance, rounding, finest**2 * rate_hz)


def step_of(readings: Floats) -> Floats:
    """Return the least by which a reading ever differs from the one before, (n_channel,), or infinity."""
    step = np.full(readings.shape[1], np.inf)
    if len(readings):
        _least_changes(readings[0], readings, step)
    return step


@compiled
def _least_changes(before: Floats, readings: Floats, step: Floats) -> bool:
    """Lower ``step`` to the least by which a reading differs from the one before; return whether it is lower."""
    lower = False
    for k in range(readings.shape[0]):
        for c in range(step.size):
            change = abs(readings[k, c] - (readings[k - 1, c] if k > 0 else before[c]))
            if 0.0 < change < step[c]:
                step[c] = change
                lower = True
    return lower


def _rounding(variance: Floats, step: Floats, n_accelerometer: int) -> Floats:
    found = np.isfinite(step)  # a channel that never changes is converted like the others of its kind
    for kind in (slice(n_accelerometer), slice(n_accelerometer, None)):
        step[kind] = np.where(found[kind], step[kind], step[kind][found[kind]].max(initial=0.0))
    hidden = np.exp(-4.0 * np.pi**2 * variance / np.maximum(step, 1e-12) ** 2)
    rounding: Floats = step**2 / 12.0 * hidden
    return rounding


class StepWatch:
    """Learns a converter's step as readings go on: one without noise shows none before something moves.

    Parameters
    ----------
    noise : Noise
        As first measured.
    n_gyro : int
        How many of the channels, the last ones, are of gyroscopes.
    """

    def __init__(self, noise: Noise, n_gyro: int = 0) -> None:
        self.noise, self._n_accelerometer = noise, len(noise.variance) - n_gyro
        self._step = np.full(len(noise.variance), np.inf)
        self._last: Floats | None = None

    def takes_quietly(self, readings: Floats) -> bool:
        """Take in readings (n, n_channel) and return True if they show no smaller step; else leave them."""
        if not len(readings):
            return True
        step = self._step.copy()
        if _least_changes(readings[0] if self._last is None else self._last, readings, step):
            return False
        self._last = readings[-1].copy()
        return True

    def look(self, readings: Floats) -> bool:
        """Take in readings (n, n_channel); return whether they change what is known of the noise."""
        if not len(readings):
            return False
        changed = _least_changes(readings[0] if self._last is None else self._last, readings, self._step)
        self._last = readings[-1].copy()
        if not changed:
            return False
        rounding = _rounding(self.noise.variance, self._step.copy(), self._n_accelerometer)
        if np.allclose(rounding, self.noise.rounding, rtol=0.1, atol=1e-12):
            return False
        self.noise = replace(self.noise, rounding=rounding)
        return True
