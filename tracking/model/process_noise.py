"""How an arm and its sensors may change of themselves, and what is too much to be noise."""

from scipy.special import chdtri

#: By how much a joint's acceleration may wander in a second [rad/s^2 or m/s^2]. While filtering more than that is
#: a jolt; an acceleration that may be anything would make the prediction a poor place to linearise in. In
#: smoothing it is all but free: a prior on it would rather believe in small motions, and so in sensors that read
#: too much.
FILTER_PUSH_STD, SMOOTHER_PUSH_STD = 3.0, 50.0
#: By how much an offset may wander in a second [m/s^2; of a gyroscope rad/s], besides what rounding does: two
#: microgees, and four degrees an hour, as data sheets of such chips have it.
WANDER_STD = 2e-5
#: Chance that mere noise misses by so much that an instant is looked at again.
_ALARM = 1e-6


def alarm_limit(n_miss: int) -> float:
    """Return the squared size of a number of misses beyond which they are not noise."""
    return float(chdtri(n_miss, _ALARM))
