"""A sensor whose samples come late: it reads what was true some time ago.

Between samples runs the polynomial of third degree through four of them (Lagrange), of which none is later than
the newest, so readings can be delayed block by block. Before its first sample the sensor is taken to have rested.
"""

import math

import numpy as np

from arm.effects.effect import EffectKind, Parameter
from arm.model import Floats

EFFECT = EffectKind(
    name="time_skew",
    sentence="the sensor's samples come late",
    place="sensor",
    parameters=(Parameter("delay_s", "s", 0.0, 1.0, neutral=0.0),),
    taken_for=("actuator_delay",),
    late="delay_s",
)


class Skew:
    """A delay of some samples, whole or not, carried from block to block.

    Parameters
    ----------
    delay : float
        In samples.
    """

    def __init__(self, delay: float) -> None:
        self._newest = max(int(delay) - 1, 0)  # of the four, in samples back
        share = delay - self._newest
        self._weights = [
            math.prod([(share - other) / (node - other) for other in range(4) if other != node])
            for node in range(4)
        ]
        self._before: Floats | None = None

    def apply(self, readings: Floats) -> Floats:
        """Return readings (n_sample, n_channel), which follow those before them, as they come late."""
        if not len(readings):
            return readings
        reach = self._newest + 3
        if self._before is None:
            self._before = np.repeat(readings[:1], reach, axis=0)
        known = np.vstack([self._before, readings])
        self._before = known[len(readings) :]
        late = np.zeros_like(readings)
        for node, weight in enumerate(self._weights):
            first = reach - self._newest - node
            late += weight * known[first : first + len(readings)]
        return late
