r"""Evidence and equality of two fitted models, the same for every likelihood.

The log evidence of a hypothesis of k parameters, sought at m places, is

.. math:: (l_1 - l_0) / \varphi - \tfrac{k}{2} \log n_{blocks} - \log m - \log \omega

nats: Schwarz' criterion over blocks of about a second, a uniform prior over the places, and prior odds of
:math:`\omega` to one against it: even for what standard models of robots have, else as many as there are families.
The gain is that of all trials, or of the learning trials alone: what one evaluating trial shows of a kind of its
own must not hide what all others show, nor the other way round. The larger one counts, less log 2.

What a model lacks makes residuals resemble each other: those of neighbours, of whole trials, and wherever a joint
moves alike. So the gain counts divided by :math:`\varphi`: the variance of the score of what was added in units of
its information (Huber 1967; Takeuchi 1976), over blocks, trials or cells of the motion, whichever is largest
(Cameron, Gelbach and Miller 2011). Two models are equal if the sum of their blocks' differences is within two of
its standard errors (Vuong 1989).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.least_squares import BLOCK_S, CLEAR_RATIO, EQUAL_SIGMAS, ODDS_NATS
from fitter.diagnosis.model import Candidate

#: The noise's size is known to a tenth (`whitening`) …
NOISE_STD_ERROR = 0.1
#: … so no more variance than this multiple of its own is a floor.
NOISE_VARIANCE_TOLERANCE = (1.0 + NOISE_STD_ERROR) ** 2


@dataclass(frozen=True)
class Fit:
    """A fitted model, with its residual of every trial.

    Attributes
    ----------
    candidate : Candidate
    residual : (n_row, n_column)
        White under the weights that all models of one comparison share.
    count : (n_trial, n_column)
        Independent numbers that a trial has.
    block : (n_row,) int
    trial : (n_block,) int
        From 0.
    learnt : (n_block,) bool
        Whether the trial may be learnt from.
    cell : (n_row, n_column) int
        Where in its motion a joint is (`motion_cells`).
    density : (n_block,)
        Logarithm of the density of what was measured, but for the residual [nats].
    acts : (n_hypothesis, n_trial) of bool
        Whether each hypothesis of its model acts in a trial.
    """

    candidate: Candidate
    residual: Floats
    count: Floats
    block: NDArray[np.intp]
    trial: NDArray[np.intp]
    learnt: NDArray[np.bool_]
    cell: NDArray[np.intp]
    density: Floats
    acts: NDArray[np.bool_]

    @cached_property
    def row_trial(self) -> NDArray[np.intp]:
        """The trial of each row, (n_row,)."""
        return self.trial[self.block]

    @cached_property
    def variance(self) -> Floats:
        """Of the residual, the likeliest of each trial, (n_trial, n_column); 1 where it is not known."""
        n_trial = len(self.count)
        squares = np.stack([np.bincount(self.row_trial, one, n_trial) for one in self.residual.T**2], axis=1)
        is_known = (self.count > 1.0) & (squares > 0.0)
        return np.where(is_known, squares / np.where(is_known, self.count, 1.0), 1.0)

    @property
    def n_number(self) -> int:
        """How many numbers its effects have."""
        return sum(one.n_number for one in self.candidate.model.hypotheses)

    @cached_property
    def log_likelihood(self) -> Floats:
        """Log-likelihood of the blocks, (n_block,), the residual's variance being the likeliest."""
        variance = self.variance[self.row_trial]
        rows = np.bincount(self.row_trial, minlength=len(self.count))
        share = (self.count / np.maximum(rows, 1)[:, None])[self.row_trial]
        squares = np.sum(self.residual**2 / variance + share * np.log(variance), axis=1)
        return self.density - 0.5 * np.bincount(self.block, squares, len(self.trial))

    def gain(self, other: "Fit") -> float:
        """Return the gain in log-likelihood of all trials over another model [nats]."""
        return float((self.log_likelihood - other.log_likelihood).sum())

    def helps(self, other: "Fit") -> bool:
        """Say whether trials that were not learnt from, if any, are likelier than under a smaller model.

        Of what acts in none of them, as a push in another trial, they say nothing: the push no longer bends the
        base parameters, and whether the error of other trials becomes larger or smaller by that is chance.
        """
        known = {id(one) for one in other.candidate.model.hypotheses}
        added = [id(one) not in known for one in self.candidate.model.hypotheses]
        is_predicted = np.any(self.acts[added][:, np.unique(self.trial[~self.learnt])])
        return not is_predicted or self.held_out(other) > 0.0

    def held_out(self, other: "Fit") -> float:
        """Return the gain of trials that were not learnt from, in standard errors; infinite if there are none."""
        gain: Floats = (self.log_likelihood - other.log_likelihood)[~self.learnt]
        return float(gain.sum()) / max(_scatter(gain), np.finfo(np.float64).tiny) if len(gain) else np.inf


def blocks_of(n_row: int, step_s: float) -> NDArray[np.intp]:
    """Return the block of about `BLOCK_S` that each of some rows is in, from 0, (n_row,).

    Parameters
    ----------
    n_row : int
    step_s : float
        Between rows.
    """
    n_block = max(1, int(n_row * step_s / BLOCK_S))
    return np.minimum(np.arange(n_row) * n_block // n_row, n_block - 1)


def dispersion(one: Fit, other: Fit, of: NDArray[np.bool_] | None = None) -> float:
    """Return the variance of the score of what was added, in units of its information, at least 1.

    Parameters
    ----------
    one, other : Fit
        With and without it.
    of : (n_block,) bool, optional
        The blocks that count; all unless given.
    """
    of = np.ones(len(one.trial), dtype=np.bool_) if of is None else of
    scale, rows = np.sqrt(one.variance)[one.row_trial], of[one.block]
    added, scaled = (other.residual - one.residual) / scale, one.residual / scale
    information = float(np.sum(added[rows] ** 2))
    if not information > 0.0:
        return 1.0
    score_terms = added * scaled
    score = np.bincount(one.block, np.sum(score_terms, axis=1), len(one.trial)) + one.density - other.density
    by_trial = [score[one.trial == trial].sum() for trial in np.unique(one.trial[of])]
    by_cell = np.bincount(one.cell[rows].ravel(), score_terms[rows].ravel())[np.unique(one.cell[rows])]
    scatter = [_summed_variance(np.asarray(one, dtype=np.float64)) for one in (score[of], by_trial, by_cell)]
    return max(1.0, max(scatter) / information)


def _summed_variance(parts: Floats) -> float:
    """Return the variance of a sum of independent parts; at a bound of a number all may pull the same way."""
    return len(parts) * float(np.var(parts, ddof=1)) if len(parts) > 1 else 0.0


def log_evidence(one: Fit, other: Fit, against: float) -> float:
    """Return the gain in log evidence over a smaller model [nats], see the module.

    Parameters
    ----------
    one, other : Fit
    against : float
        Logarithm of the prior odds against what was added, with the number of places at which its numbers were
        sought [nats].
    """
    everything = np.ones_like(one.learnt)
    sets = [everything] if np.all(one.learnt) else [everything, one.learnt]
    gain, numbers = one.log_likelihood - other.log_likelihood, one.n_number - other.n_number
    log_evidences = [
        float(gain[of].sum()) / dispersion(one, other, of) - 0.5 * numbers * np.log(of.sum()) for of in sets
    ]
    return float(max(log_evidences) - against - np.log(len(sets)))


def penalised_log_likelihood(fit: Fit) -> float:
    """Return the log-likelihood of all trials less Schwarz' penalty of the effects' numbers [nats]."""
    return float(fit.log_likelihood.sum() - 0.5 * fit.n_number * np.log(len(fit.trial)))


def is_better(one: Fit, other: Fit) -> bool:
    """Say whether a model is better than another, beyond its numbers, chance, and the blocks' scatter.

    What the learning trials leave open of the numbers shows in all trials as many times as these are longer.
    """
    gain: Floats = one.log_likelihood - other.log_likelihood
    numbers = 0.5 * (one.n_number - other.n_number) * np.log(len(gain))
    chance = ODDS_NATS * len(gain) / max(int(np.count_nonzero(one.learnt)), 1)
    return bool(gain.sum() - numbers > max(chance, EQUAL_SIGMAS * _scatter(gain)))


def _scatter(gain: Floats) -> float:
    """Return the standard error of the sum of blocks' gains [nats]."""
    return float(np.sqrt(_summed_variance(gain)))


@dataclass(frozen=True)
class Floor:
    """The floor of every joint.

    Attributes
    ----------
    ratio : (n_joint,)
        Variance of the residual, in units of the sensors' noise.
    white : (n_joint,) [N m or N]
        sqrt(D), a sample.
    steep : (n_joint,)
        E.
    """

    ratio: Floats
    white: Floats
    steep: Floats

    @property
    def is_none(self) -> bool:
        """Whether the residual is no more than the sensors' noise."""
        return bool(np.all(self.ratio <= NOISE_VARIANCE_TOLERANCE))

    @property
    def is_large(self) -> bool:
        """Whether the residual is much larger."""
        return bool(np.any(self.ratio > CLEAR_RATIO))
