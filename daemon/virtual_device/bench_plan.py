"""What the virtual arm is to do and what comes of it, for those that do not compute it themselves."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats

Truth = dict[str, Floats]


@dataclass(frozen=True)
class BenchPlan:
    """Which bench is played, and how well its sensors measure.

    ``noise`` is a factor on the bench's white noise and bias; 0 for sensors without either. ``highpass_hz`` is the
    corner of all sensors; unless given, each has that of the arm file.
    """

    arm: Arm
    seed: int
    rate_hz: float
    trials: int
    noise: float = 1.0
    imperfect_mounting: bool = False
    highpass_hz: float | None = None


@dataclass(frozen=True)
class Stretch:
    """Consecutive samples: ``counts`` (n_sample, n_channel), and of each ``stride``-th the truth, by column."""

    trial: int
    counts: NDArray[np.int16]
    truth: Truth
