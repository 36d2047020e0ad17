"""Velocity as friction needs it: behind filters that neither ring nor are slow, with the noise that they leave."""

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from arm.model import Floats
from fitter.data.trials import Trial
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, SIGMAS

#: The direction in which a joint moves is told behind a Gaussian of this width [s]: unlike a sharp filter it does
#: not ring, so nothing seems to move the other way before it starts.
_DIRECTION_S = 0.006
#: … or, where it is slow, behind wider ones, as multiples of it: noise falls eightfold with each octave.
_WIDER = (4.0, 2.0)


def velocity(trial: Trial, times: float = 1.0) -> Floats:
    """Return the velocity behind a Gaussian, (n_sample, n_joint), or behind one so many times wider."""
    width = times * _width(trial.dt_s) / trial.dt_s
    if "q" not in trial.whole:
        return np.asarray(gaussian_filter1d(trial.dq, width, axis=0, mode="nearest"), dtype=np.float64)
    slopes = gaussian_filter1d(trial.whole["q"], width, axis=0, order=1, mode="nearest") / trial.dt_s
    return np.asarray(slopes[trial.trimmed : trial.trimmed + len(trial.t)], dtype=np.float64)


def told_from_rest(trial: Trial, noise: Floats, least: Floats) -> tuple[Floats, Floats]:
    """Return the velocity where a joint is seen to move, 0 elsewhere, and its rms noise, (n_sample, n_joint) each.

    A wide filter sees slow motion, and blurs when it began: so the velocity it shows counts only where it is far
    from changing its sign.

    Parameters
    ----------
    trial : Trial
    noise : (n_joint,)
        Rms of the white noise in the angles [rad or m].
    least : (n_joint,)
        Slower joints rest.
    """
    found, left = np.zeros((2, *trial.dq.shape))
    # Twice what is told from rest is slow. The wider filter says so, for the noisier would choose by its noise.
    slow = 2.0 * SIGMAS * noise * velocity_gain(trial.dt_s)
    for times in (*_WIDER, 1.0):
        moves, own = velocity(trial, times), noise * velocity_gain(trial.dt_s, times)
        sure, may = np.abs(moves), found == 0.0
        if times > 1.0:
            may &= sure < slow
            # It must not change its sign within what the filter reaches.
            sure -= EQUAL_SIGMAS * times * _width(trial.dt_s) * np.abs(np.gradient(moves, trial.dt_s, axis=0))
        else:
            sure -= _blurred(moves, own, trial.dt_s)
        told = may & (sure > np.maximum(least, SIGMAS * own))
        found, left = np.where(told, moves, found), np.where(told, own, left)
    return found, left


def _blurred(moves: Floats, noise: Floats, dt_s: float) -> Floats:
    """Return the speed that a short rest seems to have behind the narrow filter, (n_sample, n_joint).

    The filter spreads what happens around a rest into it: a ramp of the velocity that ends there is still seen
    half a width times the acceleration high.
    """
    width = _width(dt_s)
    steep = np.abs(np.gradient(moves, dt_s, axis=0)) - SIGMAS * np.sqrt(1.5) / width * noise
    around = 2 * round(SIGMAS * width / dt_s) + 1
    return np.asarray(0.5 * width * maximum_filter1d(np.maximum(steep, 0.0), around, axis=0), dtype=np.float64)


def velocity_gain(dt_s: float, times: float = 1.0) -> float:
    """Return the rms of `velocity` per rms of white noise in the angle [1/s]."""
    return float(np.sqrt(dt_s / (4.0 * np.sqrt(np.pi) * (times * _width(dt_s)) ** 3)))


def sharper(dq: Floats, dt_s: float) -> Floats:
    """Return a velocity with what its Gaussian took off it put back but for a little (Tukey's twicing).

    Resistance by the square of a speed that was blurred would seem a percent too strong.
    """
    return np.asarray(
        2.0 * dq - gaussian_filter1d(dq, _width(dt_s) / dt_s, axis=0, mode="nearest"), dtype=np.float64
    )


def sharper_gain(dt_s: float) -> float:
    """Return the rms of `sharper` of `velocity` per rms of white noise in the angle [1/s]."""
    width = _width(dt_s) / dt_s
    impulse = np.zeros((2 * round(10 * width) + 1, 1))
    impulse[len(impulse) // 2] = 1.0
    slopes = gaussian_filter1d(impulse, width, axis=0, order=1, mode="constant") / dt_s
    return float(np.sqrt(np.sum(sharper(slopes, dt_s) ** 2)))


def _width(dt_s: float) -> float:
    return max(_DIRECTION_S, 1.5 * dt_s)
