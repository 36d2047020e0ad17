"""The covariance of an answer from draws of its errors, and from what the draws do not explain."""

import numpy as np

from arm.model import Floats


def covariance_of(departures: Floats, residual_square: Floats, found: float, scattered: Floats) -> Floats:
    """Return the covariance of an answer.

    The draws know of noise, offsets and whatever else the tracker models, not of physics that the fit leaves out.
    Where an answer leaves more than any draw does there is something of that kind; of the scatter of its residuals
    the draws then explain only their own part, and the rest is added.

    Parameters
    ----------
    departures : (n_draw, n_parameter)
        Of the draws' answers from the one that was found.
    residual_square : (n_draw,)
        Squared residuals that the draws' answers leave.
    found : float
        And the answer that was found.
    scattered : (n_parameter, n_parameter)
        Covariance by the scatter of the residuals, see `fitter.search.standard_errors`.
    """
    drawn = departures.T @ departures / len(departures)
    if not found > residual_square.max() or not np.all(np.isfinite(scattered)):
        return np.asarray(drawn, dtype=np.float64)
    return np.asarray(drawn + (1.0 - residual_square.mean() / found) * scattered, dtype=np.float64)
