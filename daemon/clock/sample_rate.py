"""The rate at which a device samples, and the one that is reckoned with.

The device's clock makes p ticks in a sample, and f / r ticks in a second of the host's, where f is what INFO says
and r the host's seconds in one of the device's: the rate is f / (p r). The rate that is reckoned with, by which
motion is integrated, is INFO's until the measured one surely differs, and stays until that surely differs again:
dead reckoning does not care for less than a hundred parts in a million, and an even step helps.
"""

import math

from daemon.clock.device_clock import ClockState
from daemon.clock.tick_step import TickStep

#: Least relative change of a rate that is followed: what `limb/health` states a rate to.
WORTH = 1e-4
#: Least change of a rate that is followed, in its standard errors: by chance one in 370.
_SURELY = 3.0


class SampleRate:
    """Measures a device's rate.

    Parameters
    ----------
    claimed_hz, tick_hz : float
        Of the device's INFO.

    Attributes
    ----------
    claimed_hz, in_use_hz : float
    measured_hz : float or None
        None before the ticks of a sample are known.
    std_ppm : float or None
        Its standard error.
    """

    def __init__(self, claimed_hz: float, tick_hz: float) -> None:
        self.claimed_hz = self.in_use_hz = claimed_hz
        self.measured_hz: float | None = None
        self.std_ppm: float | None = None
        self._tick_hz = tick_hz

    def dt_s(self, _ticks: int) -> float:
        """Return the time from one sample to the next at a tick, by the rate in use."""
        return 1.0 / self.in_use_hz

    def look(self, step: TickStep, clock: ClockState) -> None:
        """Reckon with what is known now."""
        step_std = step.std
        if not step.measured or step_std is None:
            return
        std = math.hypot(step_std, clock.rate_std)
        self.measured_hz = self._tick_hz / (step.ticks_per_sample * clock.rate)
        self.std_ppm = 1e6 * std
        if abs(self.measured_hz / self.in_use_hz - 1.0) > max(WORTH, _SURELY * std):
            self.in_use_hz = self.measured_hz
