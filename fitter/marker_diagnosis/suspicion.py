"""A hypothesis on markers: what may be wrong with them, and how much likelier it makes their errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Effect, Floats
from fitter.marker_diagnosis.trial_errors import TrialErrors


@dataclass(frozen=True)
class Suspicion:
    """A hypothesis on some trials' mean errors.

    Attributes
    ----------
    effect : Effect
        With its numbers.
    std : mapping of str to float
        Of those that were estimated.
    evidence : float
        Log ratio of the marginal likelihoods [nats].
    trials : tuple of int
        In which it acts, from 1.
    """

    effect: Effect
    std: dict[str, float]
    evidence: float
    trials: tuple[int, ...]


def log_normal(x: Floats, covariance: Floats) -> float:
    """Return the log density of a normal error (n,), less a constant; of an impossible covariance -inf."""
    sign, log_det = np.linalg.slogdet(covariance)
    return -0.5 * float(x @ np.linalg.solve(covariance, x)) - 0.5 * float(log_det) if sign > 0 else -np.inf


def known_in(trials: Sequence[TrialErrors], m: int) -> list[int]:
    """Return the trials, from 0, in which the others tell where a marker should be."""
    return [r for r, one in enumerate(trials) if np.isfinite(one.mean[m]).all()]
