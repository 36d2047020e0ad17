"""The torque equation's likelihood as the stepwise search asks for it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.torque.likelihood import Fit, TorqueLikelihood
from fitter.diagnosis.torque.screening import Screened, Screening
from fitter.side_by_side import side_by_side

#: Floors are there if chance makes trials so much likelier less often than this. The draw by which the sensors'
#: noise is known has as much chance in it as the data: the degrees of freedom count twice.
_CHANCE = 0.01


class TorqueSearch:
    """Causes sought by the torque equation.

    Parameters
    ----------
    likelihood : TorqueLikelihood
    hypotheses : sequence of Hypothesis
    """

    def __init__(self, likelihood: TorqueLikelihood, hypotheses: Sequence[Hypothesis]) -> None:
        self.likelihood, self.hypotheses = likelihood, list(hypotheses)

    def fit_base(self) -> Fit:
        """Return the model without any effect."""
        return self.likelihood.judged(self.likelihood.fit(Model()))

    def screen(self, fit: Fit) -> list[Screened]:
        """Return all hypotheses that are not in a model, those first that gain most."""
        known = {one.key for one in fit.model.hypotheses}
        return Screening(self.likelihood, fit).all([one for one in self.hypotheses if one.key not in known])

    def fit_all(self, fit: Fit, some: Sequence[Sequence[Screened]]) -> list[Fit]:
        """Return models with further hypotheses, fitted, those that are accepted kept as they are."""
        models = [fit.model for _ in some]
        for k, starts in enumerate(some):
            for start in starts:
                models[k] = models[k].plus(start.hypothesis, start.psi)
        held = len(fit.model.hypotheses)

        def fitted(model: Model) -> tuple[tuple[Floats, ...], Fit]:
            return _bare(self.likelihood.fit(model, fit, held))

        return _dressed(models, side_by_side(fitted, models))

    def judge(self, fits: Sequence[Fit]) -> list[Fit]:
        """Return fits with the likelihood of all trials."""
        found = side_by_side(lambda fit: _bare(self.likelihood.judged(fit)), list(fits))
        return _dressed([fit.model for fit in fits], found)

    def refit(self, fit: Fit) -> Fit:
        """Return a model with all its numbers sought anew."""
        return self.likelihood.judged(self.likelihood.fit(fit.model, fit))

    def fit_without(self, fit: Fit, place: int) -> Fit:
        """Return a model without one of its hypotheses, fitted."""
        return self.likelihood.judged(self.likelihood.fit(fit.model.without(place), fit))

    def is_possible(self, fit: Fit) -> bool:
        """Say whether all effects' numbers are such that the catalogue allows them."""
        at = len(fit.x) - fit.model.n_column
        for hypothesis, psi in zip(fit.model.hypotheses, fit.model.psi, strict=True):
            if not hypothesis.possible(psi, fit.x[at : at + hypothesis.n_column]):
                return False
            at += hypothesis.n_column
        return True

    def is_exact(self, fit: Fit) -> bool:
        """Say whether floors make the trials no likelier than chance would."""
        likelihood, floors = self.likelihood, sum(np.count_nonzero(one) for one in fit.floors.values())
        if not floors:
            return True
        without, none = 0.0, np.zeros((2, likelihood.arm.n_joint))
        for motion in likelihood.motions:
            own = fit.own[motion.number]
            weights = likelihood.weigh(motion, own, none)
            system = likelihood.system(fit.model, motion)
            left = weights.rows(system.Z) @ np.append(-fit.x, 1.0)
            scale = likelihood.log_scale(motion, system, own, none, weights, fit.x)
            without += float(likelihood.nats(motion, left, weights, scale).sum())
        return bool(2.0 * (fit.total - without) < chi2.ppf(1.0 - _CHANCE, 2.0 * floors))


def _bare(fit: Fit) -> tuple[tuple[Floats, ...], Fit]:
    """Return a fit as it is sent from process to process: without its hypotheses and weights."""
    return fit.model.psi, replace(fit, model=Model(), weights={})


def _dressed(models: Sequence[Model], sent: Sequence[tuple[tuple[Floats, ...], Fit]]) -> list[Fit]:
    return [replace(one, model=replace(model, psi=psi)) for model, (psi, one) in zip(models, sent, strict=True)]
