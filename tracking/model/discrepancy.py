r"""What the model lacks of the readings, and how large it is: learnt from the readings themselves.

A real arm is not quite the one in its file, and stands on something that moves. A reading is

.. math:: a_{ck} = h_c(x_k, b_k) + l_{ck} + e_{ck}

with the acceleration b of the base and what the model lacks of each channel, l: Ornstein-Uhlenbeck processes, that
of the base shared by all sensors. The noise e is the sensor's, with Student's tails where something strikes the
arm. Joints have a stationary speed (`tracking.model.stationary_process`). The sizes of all these are learnt by
expectation and maximisation (A. P. Dempster, N. M. Laird, D. B. Rubin 1977; R. H. Shumway, D. S. Stoffer 1982):
each is the mean square that the smoother expects, its own variance included. All channels of a kind share one
size, and so do all joints of a kind: with a size of its own the likelihood makes one sensor exact and leaves
everything to another.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from tracking.model.course import Course
from tracking.model.observation import Observation

#: Degrees of freedom of Student's distribution: with four it hardly loses anything to a normal one, and is not
#: misled (K. L. Lange, R. J. A. Little, J. M. G. Taylor, *Robust statistical modeling using the t distribution*,
#: 1989).
FREEDOM = 4.0
#: A joint is no slower than this on average [rad/s or m/s]: one that never moved has no speed to learn.
_SLOWEST = 0.02


@dataclass(frozen=True)
class Discrepancy:
    """Sizes of what the model lacks.

    Attributes
    ----------
    lack_std : float [m/s^2]
        Of each channel of an accelerometer.
    base_std : float [m/s^2]
        Of each axis of the base's acceleration; 0 if it stands still.
    memory_s : float [s]
        Time constant of all three.
    speed_std : (n_joint,) [rad/s or m/s]
        Of the joints.
    rate_lack_std : float [rad/s]
        Of each channel of a gyroscope; 0 without any.
    """

    lack_std: float
    base_std: float
    memory_s: float
    speed_std: Floats
    rate_lack_std: float = 0.0

    def lack_stds(self, of: Observation) -> Floats:
        """Return what the model lacks of each channel, (n_channel,)."""
        std: Floats = np.repeat(np.where(of.turning, self.rate_lack_std, self.lack_std), 3)
        return std


def speed_rate(push: Floats, speed_std: Floats) -> Floats:
    """Return the rates at which speeds of some standard deviations, pushed so hard, return to zero [1/s]."""
    rate: Floats = np.cbrt(push / (4.0 * np.maximum(speed_std, _SLOWEST) ** 2))
    return rate


def with_sizes(of: Observation, course: Course, sizes: Discrepancy, variance: Floats) -> Course:
    """Return a course with what the model lacks, and with the variance of each reading's noise."""
    return course._replace(
        doubt=variance / course.noise,
        rate=speed_rate(course.push, sizes.speed_std),
        base_std=sizes.base_std,
        lack_std=sizes.lack_stds(of),
        memory_s=sizes.memory_s,
    )
