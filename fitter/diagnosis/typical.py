"""What trials are typically left with: no trial counts for many."""

import numpy as np

from arm.model import Floats

#: No trial is left with nothing: its logarithm would count for all.
_LEAST = 1e-300


def typical(squares: Floats, told: Floats) -> float:
    """Return the geometric mean of what trials are left with, in units of noise.

    Parameters
    ----------
    squares, told : (n_trial,)
        Sum of squares that is left in each, and what noise would leave.
    """
    return float(np.exp(np.mean(np.log(np.maximum(squares / told, _LEAST)))))
