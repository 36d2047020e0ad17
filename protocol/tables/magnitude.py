"""How large motions, rates and arms usually are, and what a table's numbers say of its units by that.

Each size is taken to be log-normal: a median and a standard deviation in decades (factors of ten). That a file is
in SI units, as its contract says, has the prior probability `SI`; another unit is asked about only where it has
become nearly certain all the same.
"""

import math
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

Reading = TypeVar("Reading", bound=Hashable)

#: Prior probability that a column without a stated unit is in SI units: the contract says so.
SI = 0.99
#: Another unit is asked about from this posterior probability on that it is not SI.
SURE = 0.95


@dataclass(frozen=True)
class Size:
    """A log-normal size: its median and the standard deviation of its decimal logarithm."""

    median: float
    decades: float

    def log_likelihood(self, value: float) -> float:
        """Return the log density of a value, up to a constant that all units share; no value says nothing."""
        if not (np.isfinite(value) and value > 0.0):
            return 0.0
        return -0.5 * ((math.log10(value) - math.log10(self.median)) / self.decades) ** 2


#: Top speed of a joint that turns: 0.2 to 20 rad/s in 95 of 100. Collaborative robots turn at up to 3.1 rad/s
#: (data sheets of UR5e, LBR iiwa), human elbows at up to 20 rad/s in a throw.
JOINT_SPEED = Size(2.0, 0.5)
#: Top speed of a joint that slides: 0.03 to 3 m/s (linear axes' data sheets).
SLIDE_SPEED = Size(0.3, 0.5)
#: How far a joint turns to and fro: 0.25 to 9 rad; between a small test motion and all that cables allow.
JOINT_RANGE = Size(1.5, 0.4)
#: A wheel may turn many times, 1 to 1000 rad, and one joint in thirty is one.
WHEEL_RANGE, WHEEL = Size(30.0, 0.75), 1.0 / 30.0
#: Rate of joint motion in files: 10 Hz (a camera's) to 10 kHz (a drive's).
RATE_HZ = Size(300.0, 0.75)
#: How far an arm reaches beside what its file says: a guess within a factor of ten.
REACH_RATIO = Size(1.0, 0.5)
#: Effective samples by which a torque's residual counts: a few motions hold at least as many.
EFFECTIVE_SAMPLES = 30.0


def likely(log_likelihoods: Mapping[Reading, float], given: Reading) -> Reading | None:
    """Return the likeliest other reading of a column where the contract's is next to impossible, or None.

    Parameters
    ----------
    log_likelihoods : mapping of readings to float
        Of each reading.
    given : reading
        The reading that the contract says.
    """
    probability = probabilities(log_likelihoods, given)
    best = max(probability, key=lambda reading: probability[reading])
    return best if 1.0 - probability[given] > SURE else None


def probabilities(log_likelihoods: Mapping[Reading, float], given: Reading) -> dict[Reading, float]:
    """Return the posterior probability of each reading of a column; that of the contract's was `SI` before.

    Parameters
    ----------
    log_likelihoods : mapping of readings to float
        Of each reading.
    given : reading
        The reading that the contract says.
    """
    n = len(log_likelihoods)
    prior = {name: np.log(SI if name == given else (1.0 - SI) / (n - 1)) for name in log_likelihoods}
    weight = np.array([prior[name] + value for name, value in log_likelihoods.items()])
    share = np.exp(weight - weight.max())
    return dict(zip(log_likelihoods, (share / share.sum()).tolist(), strict=True))
