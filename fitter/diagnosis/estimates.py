r"""What was found in numbers: base parameters and effects with standard errors.

Factors and psi have a sandwich covariance over blocks, trials and cells of the motion. Residuals that resemble
their neighbours are seen within trials (Huber 1967); what whole trials have in common, in how the scores of trials
differ (Liang and Zeger 1986); and what a model lacks alike in all of them, in how cells do (`evidence`).
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.structural_parameters import structural_parameters
from fitter.diagnosis.least_squares import CONFIDENCE, ROUNDED, SLOPE, TINY
from fitter.diagnosis.model import Candidate, Hypothesis
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.search.fitted_parameter import FittedParameter
from fitter.search.standard_errors import sandwich_covariance


@dataclass(frozen=True)
class Estimates:
    """The numbers of a model.

    Attributes
    ----------
    base : BaseParameters
        Of the arm with its effects.
    values, std : (n_base,)
        NaN where a parameter was denied.
    effects : tuple of dict from name to FittedParameter
        One for each hypothesis.
    covariance : (n_factor + n_psi, n_factor + n_psi)
        Of the factors and psi together; NaN for what is not determined at all.
    """

    base: BaseParameters
    values: Floats
    std: Floats
    effects: tuple[dict[str, FittedParameter], ...]
    covariance: Floats


def estimates(regression: Regression, fitted: Candidate, covariance: Floats | None = None) -> Estimates:
    """Return a fitted model's numbers, with standard errors that allow for residuals that resemble each other.

    The covariance of factors and psi is that of the torque's equations, unless it is given.

    psi, the columns' factors and the base parameters scatter together; the parameters of an effect follow by the
    slopes of what it makes of them.
    """
    model = fitted.model
    motions = regression.motions if model.is_event else regression.learning
    if covariance is None:
        covariance = covariance_of(regression, fitted, motions)
    n_base = len(fitted.x) - sum(hypothesis.n_column for hypothesis in model.hypotheses)
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    hypothetical = regression.hypothetical(model, regression.motions[0])
    base = structural_parameters(generic_arm(regression.arm, hypothetical.arm))
    kept = regression.equations.independent(hypothetical.arm)
    values, errors = np.full((2, len(base.names)), np.nan)
    where = [base.independent.index(int(column)) for column in kept]
    values[where], errors[where] = fitted.x[:n_base], std[:n_base]
    if regression.equations.known is not None:
        values[base.independent.index(regression.equations.known[0])] = regression.equations.known[1]

    effects, at, psi_at = [], n_base, len(fitted.x)
    for hypothesis, psi in zip(model.hypotheses, model.psi, strict=True):
        own = np.r_[at : at + hypothesis.n_column, psi_at : psi_at + len(psi)]
        factors = fitted.x[at : at + hypothesis.n_column]
        effects.append(_numbers(regression, hypothesis, psi, factors, covariance[np.ix_(own, own)]))
        at, psi_at = at + hypothesis.n_column, psi_at + len(psi)
    return Estimates(base, values, errors, tuple(effects), covariance)


def significant(fitted: Candidate, covariance: Floats) -> list[bool]:
    """Say of every effect whether its size differs from none, by Wald's test at 95 %; an unknown size does not.

    The size is that of the parameters in which its torque is linear, or, where it has no columns, how far psi is
    from where it is nothing: a spring without stiffness is an offset, however well that is known.

    Parameters
    ----------
    fitted : Candidate
    covariance : (n_factor + n_psi, n_factor + n_psi)
    """
    model, said = fitted.model, list[bool]()
    numbers = np.concatenate([fitted.x, model.flat])
    at, psi_at = len(fitted.x) - model.n_column, len(fitted.x)
    for hypothesis, psi in zip(model.hypotheses, model.psi, strict=True):
        n = hypothesis.n_column
        own = np.r_[at : at + n, psi_at : psi_at + len(psi)]
        scatter = covariance[np.ix_(own, own)]
        if n:
            size, turns = _sizes(hypothesis, numbers[own])
            scatter = turns @ scatter @ turns.T
        else:
            size = psi - (np.array(hypothesis.nothing) if hypothesis.nothing else 0.0)
        known = bool(np.all(np.isfinite(scatter)))
        wald = float(size @ np.linalg.pinv(scatter, hermitian=True) @ size) if known else 0.0
        said.append(wald > scipy.stats.chi2.ppf(CONFIDENCE, max(n or len(psi), 1)))
        at, psi_at = at + n, psi_at + len(psi)
    return said


def _sizes(hypothesis: Hypothesis, both: Floats) -> tuple[Floats, Floats]:
    """Return how far the parameters in which an effect's torque is linear are from nothing, and their slopes."""
    kinds = {parameter.name: parameter for parameter in hypothesis.kind.parameters}
    linear = [k for k, name in enumerate(hypothesis.names) if name in kinds and kinds[name].linear]
    if hypothesis.is_sized_by_factors or not linear:
        return both[: hypothesis.n_column], np.eye(hypothesis.n_column, len(both))
    n = hypothesis.n_column
    neutral = np.array([kinds[hypothesis.names[k]].neutral or 0.0 for k in linear])
    return hypothesis.numbers(both[n:], both[:n])[linear] - neutral, _slopes_of(hypothesis, both)[linear]


def _slopes_of(hypothesis: Hypothesis, both: Floats) -> Floats:
    """Return the slopes of an effect's parameters with its factors and psi, (n_parameter, n_factor + n_psi)."""
    n, columns = hypothesis.n_column, []
    for k, value in enumerate(both):
        step = np.where(np.arange(len(both)) == k, SLOPE * max(abs(float(value)), np.sqrt(ROUNDED)), 0.0)
        ahead, behind = (hypothesis.numbers((both + s)[n:], (both + s)[:n]) for s in (step, -step))
        columns.append((ahead - behind) / (2.0 * step[k]))
    return np.stack(columns, axis=1) if columns else np.zeros((len(hypothesis.names), 0))


def generic_arm(arm: Arm, tilted: Arm) -> Arm:
    """Return the arm in a gravity that hides nothing that the tilted one shows."""
    x, y, z = (
        float(g0 if g == g0 else g0 + 0.7 + 0.1 * k)
        for k, (g, g0) in enumerate(zip(tilted.gravity_m_s2, arm.gravity_m_s2, strict=True))
    )
    return replace(arm, gravity_m_s2=(x, y, z))


def _numbers(
    regression: Regression, hypothesis: Hypothesis, psi: Floats, factors: Floats, covariance: Floats
) -> dict[str, FittedParameter]:
    values = hypothesis.numbers(psi, factors)
    turns = _slopes_of(hypothesis, np.concatenate([factors, psi]))
    variance = np.maximum(np.einsum("ij,jk,ik->i", turns, np.nan_to_num(covariance), turns), 0.0)
    is_undetermined = np.isnan(np.diag(covariance))
    variance[np.any(turns[:, is_undetermined] != 0.0, axis=1)] = np.nan
    std = hypothesis.standard_errors(np.sqrt(variance), regression.motions)
    known = hypothesis.determined(values, std)
    std = np.where(known, std, np.nan)
    columns = hypothesis.names, values, std, hypothesis.units(regression.arm), known
    return {
        name: FittedParameter(float(value), float(error), unit, bool(one))
        for name, value, error, unit, one in zip(*columns, strict=True)
    }


def slopes(regression: Regression, fitted: Candidate, motion: Motion) -> Floats:
    """Return the slopes of a motion's white equations, (n_slower * n_joint, n_factor + n_psi)."""
    columns = [regression.rows(fitted.model, motion).design]
    for *neighbours, step in fitted.model.central_differences():
        more, less = (regression.residual(one, fitted.x, motion) for one in neighbours)
        columns.append((less - more).reshape(-1, 1) / step)
    return np.hstack(columns)


def information_of(regression: Regression, fitted: Candidate) -> Floats:
    """Return the learning trials' information of factors and psi, weighted as in the search, (n, n)."""
    designs = [slopes(regression, fitted, motion) for motion in regression.learning]
    return np.asarray(np.sum([one.T @ one for one in designs], axis=0) + by_density(regression, fitted)[1])


def covariance_of(
    regression: Regression, fitted: Candidate, learnt_from: list[Motion], n_block: int = 240
) -> Floats:
    """Return the covariance of factors and psi together.

    Residuals that resemble their neighbours are seen within the trials that were learnt from; what whole trials
    have in common, such as how a joint comes to rest, shows in the scatter of all trials' scores.
    """
    model = fitted.model
    total = sum(len(motion.t) for motion in learnt_from)
    used = {motion.number for motion in learnt_from}
    designs, residuals = [], []
    for motion in regression.motions:
        residuals.append(regression.residual(model, fitted.x, motion).ravel())
        designs.append(slopes(regression, fitted, motion))
    fitting = [k for k, motion in enumerate(regression.motions) if motion.number in used]
    size = np.sqrt(sum(np.sum(designs[k] ** 2, axis=0) for k in fitting))
    is_determined = size > 0.0
    designs = [A[:, is_determined] / size[is_determined] for A in designs]
    extra, information = by_density(regression, fitted)
    extra, information = (
        extra[:, is_determined] / size[is_determined],
        information[np.ix_(is_determined, is_determined)] / np.outer(size[is_determined], size[is_determined]),
    )
    W = np.linalg.qr(np.vstack([*(designs[k] for k in fitting), _root(information)])).R
    grams, scores, groups = [], [], []
    for k in fitting:
        blocks = max(2, round(n_block * len(regression.motions[k].t) / total))
        for A, r in zip(np.array_split(designs[k], blocks), np.array_split(residuals[k], blocks), strict=True):
            grams.append(A.T @ A)
            scores.append(A.T @ r + extra[k] / blocks)
            groups.append(k)
    square_sum = sum(float(residuals[k] @ residuals[k]) for k in fitting)
    n_effective = float(sum(regression.weighting.n_effective(regression.motions[k]) for k in fitting))
    diagonal = np.abs(np.diag(W))
    if diagonal.min() > np.sqrt(ROUNDED) * diagonal.max():
        of_trial: NDArray[np.intp] = np.array(groups, dtype=np.intp)
        part = sandwich_covariance(np.asarray(W), np.array(grams), np.array(scores), of_trial)
        root = np.linalg.inv(W)
        plain = np.einsum("ij,ij->i", root, root)
        # What a single block determines, such as when a push began, is fitted to its noise: no score shows it.
        trials = np.repeat(np.arange(len(residuals)), [len(one) for one in residuals])
        cells = np.concatenate([regression.cells(motion).ravel() for motion in regression.motions])
        A, r = np.vstack(designs), np.concatenate(residuals)
        between = [_between(A, r, trials, extra, information), _between(A, r, cells, 0.0 * extra, information)]
        scatter = np.maximum(np.max(between, axis=0), max(square_sum / n_effective, 1.0))
        wider = np.sqrt(np.maximum(scatter * plain / np.diag(part), 1.0))
        part = part * np.outer(wider, wider)
    else:  # something is undetermined, such as how long a stuck joint was pushed: the rest is not
        gram = np.sum(grams, axis=0)
        part = np.linalg.pinv(gram, rcond=ROUNDED, hermitian=True) * max(square_sum / n_effective, 1.0)
    covariance = np.full((len(size), len(size)), np.nan)
    covariance[np.ix_(is_determined, is_determined)] = part / np.outer(size[is_determined], size[is_determined])
    return covariance


def by_density(regression: Regression, fitted: Candidate) -> tuple[Floats, Floats]:
    """Return the density's slopes, (n_motion, n_number), and its information of the motions learnt from."""
    model, n_number = fitted.model, len(fitted.x) + len(fitted.model.flat)
    mass = regression.density
    if mass is None or not np.isfinite(mass.of(model, fitted.x, regression.motions)):
        return np.zeros((len(regression.motions), n_number)), np.zeros((n_number, n_number))
    each = [mass.slopes(model, fitted.x, [motion]) for motion in regression.motions]
    learnt = {motion.number for motion in regression.motions_of(model)}
    informations = [
        one for (_, one), motion in zip(each, regression.motions, strict=True) if motion.number in learnt
    ]
    return np.stack([score for score, _ in each]), np.asarray(np.sum(informations, axis=0), dtype=np.float64)


def _root(information: Floats) -> Floats:
    """Return a matrix whose Gram matrix it is."""
    values, axes = np.linalg.eigh(information)
    return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, None] * axes.T, dtype=np.float64)


def _between(A: Floats, r: Floats, group: NDArray[np.intp], extra: Floats, information: Floats) -> Floats:
    """Return how many times more variance answers have by the scatter of groups of rows than by white noise.

    It is that of the answer to all rows together (Liang and Zeger 1986): no group is foreign to what it pulls at.
    """
    inverse = np.linalg.pinv(A.T @ A + information, rcond=ROUNDED, hermitian=True)
    change = inverse @ (A.T @ r + extra.sum(axis=0))
    _, group = np.unique(group, return_inverse=True)
    scores = np.zeros((int(group.max()) + 1, len(change)))
    np.add.at(scores, group, A * (r - A @ change)[:, None])
    scores -= information @ change / len(scores)
    scores[: len(extra)] += extra
    scores = scores @ inverse
    few = len(scores) / max(len(scores) - 1.0, 1.0)
    return np.asarray(few * np.sum(scores**2, axis=0) / np.maximum(np.diag(inverse), TINY), dtype=np.float64)
