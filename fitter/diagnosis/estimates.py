"""What was found in numbers: base parameters and effects with standard errors, and the arm that has them."""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from arm.base_parameters import BaseParameters, with_base_values
from arm.model import Arm, Effect, Estimate, Floats, Joint
from arm.physical_links import is_possible, link_parameters
from arm.regressor import standard_parameters
from fitter.diagnosis.covariance import covariance_of
from fitter.diagnosis.least_squares import CONFIDENCE, ROUNDED, SLOPE
from fitter.diagnosis.model import Candidate, Hypothesis
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.payload import Payload
from fitter.diagnosis.regression import Regression
from fitter.dynamics.physical import nearest_possible
from fitter.dynamics.structure import structural_parameters
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import NotConverged


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
        Of the factors and psi together; NaN for what is not told at all.
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
    view = regression.view(model, regression.motions[0])
    base = structural_parameters(_generic(regression.arm, view.arm))
    kept = regression.equations.independent(view.arm)
    values, errors = np.full((2, len(base.names)), np.nan)
    where = [base.independent.index(int(column)) for column in kept]
    values[where], errors[where] = fitted.x[:n_base], std[:n_base]
    if regression.equations.known is not None:
        values[base.independent.index(regression.equations.known[0])] = regression.equations.known[1]

    effects, at, psi_at = [], n_base, len(fitted.x)
    for hypothesis, psi in zip(model.hypotheses, model.psi, strict=True):
        own = np.r_[at : at + hypothesis.n_column, psi_at : psi_at + len(psi)]
        factors = fitted.x[at : at + hypothesis.n_column]
        effects.append(_numbers(hypothesis, psi, factors, covariance[np.ix_(own, own)], regression.motions))
        at, psi_at = at + hypothesis.n_column, psi_at + len(psi)
    return Estimates(base, values, errors, tuple(effects), covariance)


def possible_base(regression: Regression, fitted: Candidate) -> Floats:
    """Return base parameters of links that can exist, the nearest to those of a fitted model, (n_base,).

    Parameters
    ----------
    regression : Regression
    fitted : Candidate

    Raises
    ------
    NotConverged
        If there are none.
    """
    view = regression.view(fitted.model, regression.motions[0])
    base = structural_parameters(_generic(regression.arm, view.arm))
    where = [base.independent.index(int(column)) for column in regression.equations.independent(view.arm)]
    values = np.full(len(base.names), np.nan)
    values[where] = fitted.x[: len(where)]
    possible = nearest_possible(regression.arm, base, values)
    return np.asarray((base.combination @ standard_parameters(possible))[where], dtype=np.float64)


def significant(fitted: Candidate, covariance: Floats) -> list[bool]:
    """Say of every effect whether its size differs from none, by Wald's test at 95 %; an unknown size does not.

    The size is what its columns count, or, where it has none, how far psi is from where it is nothing.

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
        own = np.arange(at, at + n) if n else np.arange(psi_at, psi_at + len(psi))
        size = numbers[own] - (np.array(hypothesis.nothing) if hypothesis.nothing and not n else 0.0)
        scatter = covariance[np.ix_(own, own)]
        known = bool(np.all(np.isfinite(scatter)))
        wald = float(size @ np.linalg.pinv(scatter, hermitian=True) @ size) if known else 0.0
        said.append(wald > chi2.ppf(CONFIDENCE, max(len(own), 1)))
        at, psi_at = at + n, psi_at + len(psi)
    return said


def extended_arm(regression: Regression, fitted: Candidate, found: Estimates) -> Arm:
    """Return the arm with the base parameters that were learnt, and with its effects."""
    arm = regression.arm
    learnt = np.nan_to_num(found.values)
    tilted = regression.view(fitted.model, regression.motions[0]).arm
    moved = with_base_values(replace(arm, gravity_m_s2=tilted.gravity_m_s2), found.base, learnt)
    if not all(is_possible(link_parameters(joint.link)) for joint in moved.joints):
        with suppress(NotConverged):
            moved = nearest_possible(arm, found.base, found.values)
    effects = tuple(
        _effect(hypothesis, numbers)
        for hypothesis, numbers in zip(fitted.model.hypotheses, found.effects, strict=True)
    )
    split = [one for effect in effects for one in _single(effect)]
    parameters = {
        name: Estimate(float(value), float(std))
        for name, value, std in zip(found.base.names, found.values, found.std, strict=True)
        if np.isfinite(value)
    }
    return replace(
        moved,
        joints=tuple(map(_braked, moved.joints)),
        gravity_m_s2=arm.gravity_m_s2,
        base_parameters=parameters,
        effects=(*arm.effects, *split),
    )


def _braked(joint: Joint) -> Joint:
    """Return a joint whose Coulomb friction brakes: one that is fitted to push would rattle in a simulation."""
    friction = joint.friction
    return replace(joint, friction=replace(friction, coulomb_N_m=max(friction.coulomb_N_m, 0.0)))


def _generic(arm: Arm, tilted: Arm) -> Arm:
    """Return the arm in a gravity that hides nothing that the tilted one shows."""
    x, y, z = (
        float(g0 if g == g0 else g0 + 0.7 + 0.1 * k)
        for k, (g, g0) in enumerate(zip(tilted.gravity_m_s2, arm.gravity_m_s2, strict=True))
    )
    return replace(arm, gravity_m_s2=(x, y, z))


def _effect(hypothesis: Hypothesis, numbers: dict[str, FittedParameter]) -> Effect:
    values: dict[str, object] = {name: number.value for name, number in numbers.items()}
    if isinstance(hypothesis, Payload):
        values |= (
            {"since_s": hypothesis.since_s}
            if hypothesis.since_s is not None
            else {"trials": sorted(hypothesis.trials)}
        )
    return Effect(hypothesis.kind.name, values, joints=tuple(j + 1 for j in hypothesis.joints))


def _single(effect: Effect) -> list[Effect]:
    """Return one effect for each of several pushes."""
    if "start_s_1" not in effect.parameters:
        return [effect]
    pushes = []
    k = 1
    while f"start_s_{k}" in effect.parameters:
        names = ("start_s", "duration_s", "torque_N_m")
        pushes.append(replace(effect, parameters={name: effect.parameters[f"{name}_{k}"] for name in names}))
        k += 1
    return pushes


def _numbers(
    hypothesis: Hypothesis, psi: Floats, factors: Floats, covariance: Floats, motions: list[Motion]
) -> dict[str, FittedParameter]:
    values = hypothesis.numbers(psi, factors)
    both = np.concatenate([factors, psi])
    n = len(factors)
    turns = np.empty((len(values), len(both)))
    for k in range(len(both)):
        step = np.zeros(len(both))
        step[k] = SLOPE * max(abs(both[k]), np.sqrt(ROUNDED))
        ahead, behind = (hypothesis.numbers((both + s)[n:], (both + s)[:n]) for s in (step, -step))
        turns[:, k] = (ahead - behind) / (2.0 * step[k])
    variance = np.maximum(np.einsum("ij,jk,ik->i", turns, np.nan_to_num(covariance), turns), 0.0)
    untold = np.isnan(np.diag(covariance))
    variance[np.any(turns[:, untold] != 0.0, axis=1)] = np.nan
    std = np.sqrt(variance + hypothesis.hidden(motions, values) ** 2)
    return {
        name: FittedParameter(float(value), float(error), unit, bool(np.isfinite(error)))
        for name, value, error, unit in zip(hypothesis.names, values, std, hypothesis.units, strict=True)
    }
