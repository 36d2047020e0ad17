r"""What a model lacks on average in each trial: a constant torque of each joint, another one in every trial.

An encoder that is set to zero anew before every recording, while dry friction holds the arm off its equilibrium,
turns gravity by another angle in each; a cable pulls in another way. Nothing in one trial tells such an offset
from a cause that acts in all of them, but the trials differ: their offsets are normal with a variance B. What is
the same in all trials, drifts from one to the next, or changes once, as with a load, is no part of B but a cause:
B is the scatter of successive trials.
"""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.least_squares import MAD_STD, NEGLIGIBLE, ODDS_NATS
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.weighting import Weighting


def offset_sizes(
    equations: Equations, weighting: Weighting, model: Model, x: Floats, motions: Sequence[Motion]
) -> Floats:
    r"""Return the standard deviation of the trials' offsets, sqrt(B), (n_joint,) [N m or N].

    Each trial's offset by weighted least squares has the variance v of the other noise, so ``B = s^2 - v`` with
    the scatter s of successive trials: their differences are sqrt(2) times as large (von Neumann 1941), and their
    median does not depend on a few. It is 0 unless the offsets are a hundred times likelier with it.

    Parameters
    ----------
    equations : Equations
    weighting : Weighting
        Of the noise without offsets.
    model : Model
    x : (n_factor,)
    motions : sequence of Motion
        Those that may be learnt from, in any order; of one alone there is no scatter.
    """
    motions = sorted(motions, key=lambda one: float(one.t[0]))
    per_trial = [_offsets(equations, weighting, model, x, one) for one in motions]
    return np.array([_scatter(*trials) for trials in np.moveaxis(np.array(per_trial), (1, 2), (1, 0))])


def _scatter(offsets: Floats, variances: Floats) -> float:
    """Return sqrt(B) of one joint, from its offsets (n_trial,) and what they are uncertain by."""
    known = np.isfinite(variances)
    if np.count_nonzero(known) < 2:
        return 0.0
    off, v = offsets[known], variances[known]
    scatter = MAD_STD * float(np.median(np.abs(np.diff(off)))) / np.sqrt(2.0)
    B = max(scatter**2 - float(np.median(v)), 0.0)
    off = off - np.average(off, weights=1.0 / (B + v))
    gain = 0.5 * float(np.sum(off**2 / v - off**2 / (B + v) - np.log1p(B / v)))
    return float(np.sqrt(B)) if gain > ODDS_NATS else 0.0


def _offsets(equations: Equations, weighting: Weighting, model: Model, x: Floats, motion: Motion) -> Floats:
    """Return the offset of each joint in one trial, and its variance, (2, n_joint); inf of a joint that rests."""
    residual = weighting.filtered(motion, equations.residual_torque(model, x, motion)).ravel()
    n_sample, n_joint = motion.q.shape
    one = np.ones((n_sample, 1))
    columns = np.hstack([weighting.filtered_at(motion, joint, one) for joint in range(n_joint)])
    whole = np.hstack([weighting.whitened_at(motion, joint, one) for joint in range(n_joint)])
    known = np.sum(columns**2, axis=0) > NEGLIGIBLE * np.sum(whole**2, axis=0)
    found = np.stack([np.zeros(n_joint), np.full(n_joint, np.inf)])
    covariance = np.linalg.pinv(columns[:, known].T @ columns[:, known])
    found[0, known] = covariance @ (columns[:, known].T @ residual)
    found[1, known] = np.diag(covariance)
    return found
