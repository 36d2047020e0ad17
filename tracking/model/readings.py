"""A whole recording, decimated to the rate of the frames."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.errors import ConfigError, DataError
from tracking.model.decimation import Decimator
from tracking.model.first_rest import FirstReadings, first_readings
from tracking.model.noise import Noise, noise_of
from tracking.model.zero_velocity import window_frames

#: Readings that the noise can be learnt from, at the least.
_FEWEST = 8


@dataclass(frozen=True)
class Readings:
    """Decimated readings.

    Attributes
    ----------
    values : (n, n_channel) [m/s^2, of gyroscopes rad/s]
        Not a number where they were lost.
    dt_s : float
        From frame to frame.
    t0_s : float
        Time of the first frame, counted from the first sample.
    noise : Noise
        Of one sample.
    factor : int
        Samples a frame.
    """

    values: Floats
    dt_s: float
    t0_s: float
    noise: Noise
    factor: int

    @property
    def present(self) -> NDArray[np.bool_]:
        """Which frames have a reading, (n,)."""
        there: NDArray[np.bool_] = ~np.isnan(self.values[:, 0])
        return there

    @cached_property
    def first(self) -> FirstReadings:
        """Readings of the first quarter of a second."""
        return first_readings(self.values, self.dt_s, self.noise, self.factor)

    @property
    def first_mean(self) -> Floats:
        """Mean reading of the first quarter of a second, (n_channel,)."""
        return self.first.mean

    @property
    def begins_in_motion(self) -> bool:
        """Whether the readings of the first quarter of a second are all there, and change."""
        cell, n_cell = window_frames(self.dt_s)
        seen = len(self.values) >= cell * n_cell and self.present[: cell * n_cell].all()
        return bool(seen) and not self.begins_steadily

    @property
    def begins_steadily(self) -> bool:
        """Whether the readings of the first quarter of a second stay what they are."""
        return self.first.steady


class ReadingsBuilder:
    """Takes in samples and gaps, and gives out what a smoother needs.

    Parameters
    ----------
    rate_hz : float
        Of the samples.
    n_channel : int
    frame_rate_hz : float
        Rounded to what divides the sampling rate, which it is where that is lower.
    n_gyro : int
        How many of the channels, the last ones, are of gyroscopes.

    Raises
    ------
    ConfigError
        If a rate makes no sense.
    """

    def __init__(self, rate_hz: float, n_channel: int, frame_rate_hz: float = 1000.0, n_gyro: int = 0) -> None:
        if not (frame_rate_hz > 0.0 and rate_hz > 0.0):
            raise ConfigError(f"rates are {frame_rate_hz:g} and {rate_hz:g} Hz, expected more than 0")
        self._factor = max(1, round(rate_hz / frame_rate_hz))
        self._rate_hz, self._n_channel, self._n_gyro = rate_hz, n_channel, n_gyro
        self._decimator = Decimator(self._factor, n_channel)
        self._frames: list[Floats] = []
        self._stretch: list[Floats] = []
        self._longest: Floats = np.empty((0, n_channel))

    def push(self, samples: Floats) -> None:
        """Take in samples (n, n_channel)."""
        if samples.ndim != 2 or samples.shape[1] != self._n_channel:
            raise DataError(f"readings have shape {samples.shape}, expected (n, {self._n_channel})")
        self._stretch.append(samples)
        self._frames.append(self._decimator.push(samples))

    def gap(self, n_samples: int) -> None:
        """Leave out samples that were lost."""
        self._close()
        self._frames.append(np.full((self._decimator.skip(n_samples), self._n_channel), np.nan))

    def done(self) -> Readings:
        """Return all that was taken in.

        Raises
        ------
        DataError
            If there is too little of it.
        """
        self._close()
        if len(self._longest) < _FEWEST:
            raise DataError(f"{len(self._longest)} samples without a gap, expected at least {_FEWEST}")
        dt_s = self._factor / self._rate_hz
        t0_s = (self._factor // 2) / self._rate_hz
        noise = noise_of(self._longest, self._rate_hz, self._n_gyro)
        return Readings(np.concatenate(self._frames), dt_s, t0_s, noise, self._factor)

    def _close(self) -> None:
        self._frames.append(self._decimator.flush())
        stretch = np.concatenate(self._stretch) if self._stretch else self._longest[:0]
        self._longest = max(self._longest, stretch, key=len)
        self._stretch = []
