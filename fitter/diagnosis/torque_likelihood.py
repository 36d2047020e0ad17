"""The likelihood of the torque equation, with a floor of what the model lacks, as the search asks for it."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import scipy

from fitter.diagnosis.error_floor import floored, part_of_floor
from fitter.diagnosis.estimates import estimates, significant
from fitter.diagnosis.evidence import (
    NOISE_STD_ERROR,
    NOISE_VARIANCE_TOLERANCE,
    Fit,
    Floor,
    blocks_of,
    penalised_log_likelihood,
)
from fitter.diagnosis.friction_limits import FrictionLimits
from fitter.diagnosis.least_squares import ITERATIONS, NEGLIGIBLE, ODDS_NATS, ROUNDED
from fitter.diagnosis.link_forces import free_link
from fitter.diagnosis.mass_density import MassDensity
from fitter.diagnosis.model import Candidate, Hypothesis, Model
from fitter.diagnosis.possible_masses import possible_base
from fitter.diagnosis.refinement import Starts, by_learning, fitted
from fitter.diagnosis.regression import Regression

Progress = Callable[[int, int], None]
Screen = Callable[[Regression, Candidate, Sequence[Hypothesis], Starts, Progress | None], list[Candidate]]
Events = Callable[[Regression, Model], Sequence[Hypothesis]]


class TorqueLikelihood:
    """The likelihood of a run's torque equations.

    Parameters
    ----------
    regression : Regression
    tried : sequence of Hypothesis
    screen : callable
        Tries hypotheses in addition to a model's and returns them fitted (`screening`).
    progress : callable, optional
        Called with how many hypotheses were tried, and how many there are.
    events : callable, optional
        Returns what may have happened beside a model, at the times and in the trials that explain most.
    moved : float
        Share of what the model lacks that moved the arm, where the torque was measured (`mass_density`).

    Attributes
    ----------
    regression : Regression
        Under the weights that were used last.
    floor, base_floor : Floor
        Of the model by which these were made, and of the base model.
    in_vain : list of Candidate
        What was tried with the base model and is no option: it explains next to nothing, only impossible numbers
        would, or its size does not differ from none.
    """

    def __init__(
        self,
        regression: Regression,
        tried: Sequence[Hypothesis],
        screen: Screen,
        progress: Progress | None = None,
        events: Events | None = None,
        moved: float = 0.5,
    ) -> None:
        self.regression = regression
        self.floor = self.base_floor = Floor(*np.ones((3, regression.arm.n_joint)))
        self.in_vain: list[Candidate] = []
        self._tried, self._screen, self._progress, self._starts = list(tried), screen, progress, Starts()
        self._events = events
        measured = all(motion.trial.tau is not None for motion in regression.motions)
        driven = any(np.any(motion.u) for motion in regression.motions)
        self._weight = moved if measured and driven else 1.0

    def base(self) -> Fit:
        """Return the model without any effect, under weights of its own."""
        base = self._settled(fitted(self.regression, Model()))
        self.base_floor = self.floor
        return self.fit_of(base)

    def options(self, fit: Fit) -> list[Fit]:
        """Return a model with one hypothesis more, for all of them that are possible, the likeliest first."""
        accepted = fit.candidate
        known = {one.key for one in accepted.model.hypotheses}
        tried = [one for one in self._tried if one.key not in known]
        found = self._screen(self.regression, accepted, tried, self._starts, self._progress)
        better = [one for one in found if one.squares is not accepted.squares and self._is_significant_event(one)]
        if not accepted.model.hypotheses:
            options = {id(one) for one in better}
            self.in_vain = [one for one in found if id(one) not in options]
        return sorted(map(self.fit_of, better), key=penalised_log_likelihood, reverse=True)

    def _is_significant_event(self, candidate: Candidate) -> bool:
        """Say whether an event's column, if one was added, has a size significantly different from zero.

        A trial in which something happened may differ from others by what the model lacks as well.
        """
        hypothesis = candidate.hypothesis
        if not (hypothesis.is_event and hypothesis.n_column):
            return True
        return significant(candidate, estimates(self.regression, candidate).covariance)[-1]

    def is_significant(self, fit: Fit) -> bool:
        """Say whether the sizes of all effects differ from none, and can be: under other weights they may not.

        Two effects that cancel each other imitate a third. Of what is not linear in any number the evidence says
        so: how far psi is from nothing in standard errors depends on how it is written (Wald's test is not
        invariant), and its slope far from nothing on what other trials miss there. It has to be determined.
        """
        candidate = fit.candidate
        covariance = estimates(self.regression, candidate).covariance
        determined = candidate.model.at(np.diag(covariance)[len(candidate.x) :]).psi
        tests = zip(candidate.model.hypotheses, significant(candidate, covariance), determined, strict=True)
        return is_possible(candidate) and all(
            differs if one.n_column else bool(np.all(np.isfinite(psi))) for one, differs, psi in tests
        )

    def joined(self, fit: Fit, options: Sequence[Fit]) -> Fit | None:
        """Return a model with the last hypothesis of each of some options; None if its numbers are impossible."""
        model = fit.candidate.model
        for one in options:
            model = model.plus(one.candidate.hypothesis, one.candidate.model.psi[-1])
        candidate = fitted(self.regression, model, held=len(fit.candidate.model.hypotheses))
        return self.fit_of(candidate) if is_possible(candidate) else None

    def without(self, fit: Fit, place: int) -> Fit:
        """Return a model without one of its hypotheses, fitted."""
        return self.fit_of(fitted(self.regression, fit.candidate.model.without(place)))

    def instead(self, fit: Fit, place: int, other: Fit) -> Fit | None:
        """Return a model without one of its hypotheses and with another model's last one; None if impossible."""
        model = fit.candidate.model.without(place)
        model = model.plus(other.candidate.hypothesis, other.candidate.model.psi[-1])
        candidate = fitted(self.regression, model)
        return self.fit_of(candidate) if is_possible(candidate) else None

    def reweighted(self, fit: Fit) -> Fit:
        """Return a model under weights of its own, all its numbers sought anew."""
        return self.fit_of(self._settled(fitted(self.regression, fit.candidate.model)))

    def _settled(self, candidate: Candidate) -> Candidate:
        """Return a model and weigh by its own floor: under another model's its numbers are off, and so is this."""
        was = np.full(self.regression.arm.n_joint, np.inf)
        for _ in range(ITERATIONS):
            self.reweigh(candidate)
            candidate = self._resought(fitted(self.regression, candidate.model))
            now = np.maximum(
                self.floor.ratio, NOISE_VARIANCE_TOLERANCE
            )  # what is less is no floor, and weighs nothing
            if np.all(np.abs(now - was) < NOISE_STD_ERROR * now):  # it is no better known
                break
            was = now
        return candidate

    def _resought(self, candidate: Candidate) -> Candidate:
        """Return a model whose events are at the times and in the trials that fit best under these weights."""
        model = candidate.model
        for place, hypothesis in enumerate(model.hypotheses):
            if not hypothesis.is_event or self._events is None:
                continue
            for one in self._events(self.regression, model.without(place)):
                if one.key == hypothesis.key and one.n_number == hypothesis.n_number:
                    other = fitted(self.regression, candidate.model.instead(place, one))
                    candidate = min(candidate, other, key=lambda some: float(some.squares.sum()))
        return candidate

    def log_places(self, hypothesis: Hypothesis) -> float:
        """Return the logarithm of the number of places at which a hypothesis is sought."""
        return hypothesis.log_places(self.regression.motions)

    def is_exact(self, fit: Fit, everywhere: bool = False) -> bool:
        """Say whether a model leaves no more than the sensors' noise, on average and in every single trial.

        What acts for some moments, as a limit does, is lost in the average. Unless all trials are asked for, those
        that may be learnt from count: what others show beside them cannot be learnt from these.
        """
        candidate = self._by_torque(fit.candidate)
        count = np.array([everywhere or motion.learn for motion in self.regression.motions])
        n_effective = self.regression.n_effective[count]
        most = NOISE_VARIANCE_TOLERANCE * scipy.stats.chi2.isf(np.exp(-ODDS_NATS) / len(n_effective), n_effective)
        return floored(self.regression, candidate)[2].is_none and bool(np.all(candidate.squares[count] <= most))

    def has_large_residual(self, fit: Fit) -> bool:
        """Say whether a model leaves so much that two hypotheses may hide each other in it."""
        return self.floor.is_large

    def everywhere(self, fit: Fit) -> Fit:
        """Return a model fitted to all trials, as if all might be learnt from."""
        whole = self._fit_of(fitted(self.regression, fit.candidate.model, to_all=True))
        return replace(whole, learnt=np.ones_like(whole.learnt))

    def fit_of(self, candidate: Candidate) -> Fit:
        """Return a model with its residual of every trial, and the density of its motions."""
        return self._fit_of(by_learning(self.regression, candidate) if candidate.model.is_event else candidate)

    def _fit_of(self, candidate: Candidate) -> Fit:
        regression, step_s = self.regression, self.regression.weighting.stride
        residual, block, cell, trial, learnt, density = [], [], [], list[int](), list[bool](), list[float]()
        beyond = regression.beyond(candidate.model, candidate.x, regression.motions)
        for k, (motion, at_rest) in enumerate(zip(regression.motions, beyond, strict=True)):
            white = regression.residual(candidate.model, candidate.x, motion)
            own = blocks_of(len(white), step_s * motion.dt_s)
            n_block = int(own[-1]) + 1
            residual += [white, at_rest]
            block.append(own + len(trial))
            cell.append(regression.cells(motion))
            if regression.rests is not None:
                _, middle = regression.rests.places(motion)
                block.append(middle * n_block // len(motion.t) + len(trial))
                cell.append(regression.cells_at(motion, middle))
            trial += [k] * n_block
            learnt += [motion.learn] * n_block
            mass = regression.density
            whole = mass.of(candidate.model, candidate.x, [motion]) if mass is not None else 0.0
            # A trial in which masses vanish is so unlikely that nothing makes up for it.
            density += [max(whole, -1.0 / ROUNDED) / n_block] * n_block
        return Fit(
            candidate,
            np.concatenate(residual),
            np.array([regression.weighting.n_effective_at_joints(motion) for motion in regression.motions]),
            np.concatenate(block),
            np.array(trial),
            np.array(learnt),
            np.concatenate(cell),
            np.array(density),
            np.array(
                [[one.acts_in(motion) for motion in regression.motions] for one in candidate.model.hypotheses],
                dtype=np.bool_,
            ).reshape(-1, len(regression.motions)),
        )

    def _by_torque(self, candidate: Candidate) -> Candidate:
        """Return a model fitted by the torque alone: the cost of the motions' density is no floor."""
        if self.regression.density is None:
            return candidate
        with self.regression.by_torque_alone():
            return fitted(self.regression, candidate.model)

    def reweigh(self, candidate: Candidate) -> None:
        """Weigh the equations by the sensors' noise under a model, and its floor."""
        own, weighted, self.floor = floored(self.regression, self._by_torque(candidate))
        links = partial(free_link, self.regression.equations, candidate)
        given = self.regression.equations.given.hypotheses
        for one in dict.fromkeys((*given, *self._tried, *candidate.model.hypotheses)):
            one.follow(links, self.regression.motions)
        anew = self.regression.weighted_by(weighted)
        anew.sensors = own
        anew.floor_part = part_of_floor(own, weighted)
        anew.own_share = anew.noise_share(candidate.model, candidate.x)
        weight = self._weight * anew.floor_part
        if weight > NEGLIGIBLE:
            count = {motion.number: anew.weighting.n_effective_at_joints(motion) for motion in anew.motions}
            start = candidate.x[: len(candidate.x) - candidate.model.n_column]
            density = MassDensity(anew.equations, anew.motions, weight, count, start)
            if not density.is_possible(start):  # a torque the wrong way round, or of another size
                start = possible_base(self.regression, candidate, density.is_possible)
                density = MassDensity(anew.equations, anew.motions, weight, count, start)
            anew.density = density
            anew.rests = FrictionLimits(anew.equations, anew.motions, anew.floor_part)
        self.regression = anew
        self._starts.forget()


def is_possible(candidate: Candidate) -> bool:
    """Say whether all effects' numbers are such that the catalogue allows them."""
    model, at = candidate.model, len(candidate.x) - candidate.model.n_column
    for hypothesis, psi in zip(model.hypotheses, model.psi, strict=True):
        if not hypothesis.possible(psi, candidate.x[at : at + hypothesis.n_column]):
            return False
        at += hypothesis.n_column
    return True
