"""A sensor whose samples come late: it reads what was true some time ago.

Between samples runs the polynomial of third degree through four of them (Lagrange), of which none is later than
the newest, so readings can be delayed block by block. Before its first sample the sensor is taken to have rested.
"""

import math

import numpy as np
import scipy.signal

from arm.effects.effect import EffectKind, Parameter
from arm.model import Floats

EFFECT = EffectKind(
    name="time_skew",
    sentence="the sensor's samples come late",
    place="sensor",
    parameters=(Parameter("delay_s", "s", 0.0, 1.0, neutral=0.0),),
    taken_for=("actuator_delay",),
)


class Skew:
    """A delay of some samples, whole or not, carried from block to block.

    Parameters
    ----------
    delay : float
        In samples.
    """

    def __init__(self, delay: float) -> None:
        first = max(int(delay) - 1, 0)  # the polynomial's newest sample, in samples back
        share = delay - first
        weights = [
            math.prod([(share - other) / (node - other) for other in range(4) if other != node])
            for node in range(4)
        ]
        self._weights: Floats = np.concatenate([np.zeros(first), weights])
        self._state: Floats | None = None

    def apply(self, readings: Floats) -> Floats:
        """Return readings (n_sample, n_channel), which follow those before them, as they come late."""
        if self._state is None:
            resting = scipy.signal.lfilter_zi(self._weights, [1.0])
            self._state = resting[:, None] * readings[:1]
        late, self._state = scipy.signal.lfilter(self._weights, [1.0], readings, axis=0, zi=self._state)
        return np.asarray(late, dtype=np.float64)
