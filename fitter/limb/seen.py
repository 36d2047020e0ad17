"""Medians and means over frames of what was seen, without a word where nothing was."""

import warnings

import numpy as np

from arm.model import Floats


def median_seen(x: Floats) -> Floats:
    """Return the median over the first axis, NaN left out; NaN where nothing is left."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmedian(x, axis=0))


def mean_seen(x: Floats, axis: int = 0) -> Floats:
    """Return the mean over an axis, NaN left out; NaN where nothing is left."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmean(x, axis=axis))
