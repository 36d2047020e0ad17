"""How far and how fast joints turn, and whether that is in degrees where radians are expected."""

import numpy as np

from protocol.tables.magnitude import JOINT_RANGE, JOINT_SPEED, WHEEL, WHEEL_RANGE, likely
from protocol.tables.table import Floats

#: A table is thinned to about this many rows: enough to compare units.
ROWS = 400
#: Top speeds are this quantile of all, so that a single jump is none.
_TOP = 0.95
DEGREE = np.pi / 180.0


def top_speeds(t: Floats, q: Floats) -> Floats:
    """Return the top speed of every joint [rad/s or m/s], (n_joint,), single jumps left out."""
    coarse = max(1, (len(t) - 1) // ROWS)  # the resolution of an encoder is not a speed
    speed = np.abs(np.diff(q[::coarse], axis=0)) / np.diff(t[::coarse])[:, None]
    return np.asarray(np.quantile(speed, _TOP, axis=0), dtype=np.float64)


def turning_likelihood(ranges: Floats, speeds: Floats) -> float:
    """Return the log likelihood of ranges [rad] and top speeds [rad/s] of joints, of which some may be wheels."""
    total = 0.0
    for span, speed in zip(ranges.tolist(), speeds.tolist(), strict=True):
        if span > 0.0:
            limb = np.log(1.0 - WHEEL) + JOINT_RANGE.log_likelihood(span)
            wheel = np.log(WHEEL) + WHEEL_RANGE.log_likelihood(span)
            total += float(np.logaddexp(limb, wheel)) + JOINT_SPEED.log_likelihood(speed)
    return total


def look_like_degrees(t: Floats, q: Floats) -> bool:
    """Say whether angles can hardly be radians, by how far and fast they go.

    Parameters
    ----------
    t : ndarray of shape (n,)
        [s]
    q : ndarray of shape (n, n_turning)
        Of joints that turn.
    """
    ranges, speeds = np.ptp(q, axis=0), top_speeds(t, q)
    sizes = {name: turning_likelihood(k * ranges, k * speeds) for name, k in (("rad", 1.0), ("deg", DEGREE))}
    return likely(sizes, "rad") is not None
