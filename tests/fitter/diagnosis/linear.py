"""A likelihood of plain linear regression, by which `Stepwise` can be asked for causes that are known."""

from collections.abc import Sequence

import numpy as np

from arm.effects.catalogue import catalogue
from arm.model import Floats
from fitter.diagnosis.estimates import significant
from fitter.diagnosis.evidence import Fit, penalised_log_likelihood
from fitter.diagnosis.model import Candidate, Hypothesis, Model
from fitter.diagnosis.motion import HypotheticalMotion

#: Rows a block, blocks a trial; places in the motion.
ROWS, BLOCKS = 10, 5
N_CELL = 40


class Columns(Hypothesis):
    """Some columns that may explain a series together.

    Parameters
    ----------
    some : sequence of int
    effect : str
        What they are called.
    """

    def __init__(self, *some: int, effect: str = "joint_spring") -> None:
        super().__init__(catalogue()[effect], some)
        self.n_column = len(some)

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return the motion as it is: there is none."""
        return hypothetical

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the factors."""
        return factors


class LinearLikelihood:
    """Of a series y that columns may explain.

    Parameters
    ----------
    columns : (n_row, n_column)
    y : (n_row,)
    tried : sequence of Columns
    learnt : float
        The share of the trials that may be learnt from.
    wrong : bool
        Whether two hypotheses may hide each other.
    exact : float
        A model is exact if it leaves no more variance.
    """

    def __init__(
        self,
        columns: Floats,
        y: Floats,
        tried: Sequence[Columns],
        *,
        learnt: float = 0.5,
        wrong: bool = True,
        exact: float = 0.0,
    ) -> None:
        self.columns, self.y, self.tried, self.wrong, self.exact = columns, y, tuple(tried), wrong, exact
        self.block = np.arange(len(y)) // ROWS
        self.trial = np.arange(self.block[-1] + 1) // BLOCKS
        self.learnt = self.trial < learnt * (self.trial[-1] + 1)
        self.weighed = 0

    def fit_of(self, *hypotheses: Hypothesis, everywhere: bool = False) -> Fit:
        """Return a model with some hypotheses, by least squares on what may be learnt from, or on all trials."""
        A = self.columns[:, [k for one in hypotheses for k in one.joints]]
        learnt = self.learnt | everywhere
        may = learnt[self.block]
        x = np.linalg.lstsq(A[may], self.y[may], rcond=None)[0]
        left = (self.y - A @ x)[:, None]
        model = Model(hypotheses, (np.zeros(0),) * len(hypotheses))
        candidate = Candidate(model, x, np.bincount(self.trial[self.block], left[:, 0] ** 2))
        nothing = np.zeros(len(self.trial))
        count = ROWS * np.bincount(self.trial)[:, None].astype(np.float64)
        # All is noise: nothing systematic is lacking that no scatter shows.
        cell = (np.arange(len(left)) % N_CELL)[:, None]
        acts = np.ones((len(hypotheses), self.trial[-1] + 1), dtype=np.bool_)
        return Fit(candidate, left, count, self.block, self.trial, learnt, cell, nothing, acts)

    def base(self) -> Fit:
        """Return the model without any column."""
        return self.fit_of()

    def options(self, fit: Fit) -> Sequence[Fit]:
        """Return a model with one hypothesis more, for all, the likeliest first."""
        known = fit.candidate.model.hypotheses
        return sorted(
            (self.fit_of(*known, one) for one in self.tried if one not in known),
            key=penalised_log_likelihood,
            reverse=True,
        )

    def joined(self, fit: Fit, options: Sequence[Fit]) -> Fit | None:
        """Return a model with the last hypothesis of each of some options."""
        return self.fit_of(*fit.candidate.model.hypotheses, *(one.candidate.hypothesis for one in options))

    def without(self, fit: Fit, place: int) -> Fit:
        """Return a model without one of its hypotheses."""
        return self.fit_of(*fit.candidate.model.without(place).hypotheses)

    def instead(self, fit: Fit, place: int, other: Fit) -> Fit | None:
        """Return a model without one of its hypotheses and with another model's last one."""
        return self.fit_of(*fit.candidate.model.without(place).hypotheses, other.candidate.hypothesis)

    def everywhere(self, fit: Fit) -> Fit:
        """Return a model by least squares on all trials."""
        return self.fit_of(*fit.candidate.model.hypotheses, everywhere=True)

    def reweighted(self, fit: Fit) -> Fit:
        """Return a model as it is: least squares have no weights."""
        self.weighed += 1
        return fit

    def log_places(self, hypothesis: Hypothesis) -> float:
        """Return zero: there is one place."""
        return 0.0

    def is_significant(self, fit: Fit) -> bool:
        """Say whether the factors of each hypothesis differ from none: white noise of known columns."""
        A = self.columns[:, [k for one in fit.candidate.model.hypotheses for k in one.joints]]
        may = self.learnt[self.block]
        scatter = np.mean(fit.residual[may] ** 2) * np.linalg.inv(A[may].T @ A[may])
        return all(significant(fit.candidate, scatter))

    def is_exact(self, fit: Fit) -> bool:
        """Say whether a model leaves no more than it may."""
        return bool(np.mean(fit.residual**2) <= self.exact)

    def has_large_residual(self, fit: Fit) -> bool:
        """Say whether two hypotheses may hide each other."""
        return self.wrong
