"""Medians and means that ignore NaN, without a warning where all is NaN."""

import warnings

import numpy as np

from arm.model import Floats


def nan_median(x: Floats) -> Floats:
    """Return the median over the first axis, NaN left out; NaN where all is NaN."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmedian(x, axis=0))


def nan_mean(x: Floats, axis: int = 0) -> Floats:
    """Return the mean over an axis, NaN left out; NaN where all is NaN."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmean(x, axis=axis))
