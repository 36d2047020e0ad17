"""The common factor from a torque that was measured in some of the trials."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.controller.instrumental_variables import InstrumentalVariables
from fitter.controller.law_ambiguity import LawNullSpace
from fitter.controller.law_equations import LawEquations
from fitter.controller.law_fit import LawFit, equations_gram
from fitter.search.standard_errors import sandwich_covariance
from limbcal.errors import DataError

_BLOCKS = 100


def scaled_to_torque(fit: LawFit, instruments: InstrumentalVariables, trials: Sequence[LawEquations]) -> LawFit:
    """Return a fit whose factor is that of the measured torque.

    The torque of the law that was found, with any factor, is held against the measured one; the law's torque in
    the simulated motion is the instrument, because that in the measured one has noise.

    Parameters
    ----------
    fit : LawFit
        With one kp known for each factor, and nothing else.
    instruments : InstrumentalVariables
    trials : sequence of LawEquations
        Those without torque are passed over.

    Raises
    ------
    DataError
        If no trial has a torque, or the joints of a factor stood still in those that have.
    """
    measured = [equations for equations in trials if equations.tau is not None]
    if not measured:
        raise DataError("no trial has a torque; expected columns tau1… in some of them")
    columns, n_base, n = fit.columns, fit.columns.n_base, len(fit.values)
    simulated = [instruments.rows(fit.values, equations) for equations in measured]
    values, spread = fit.values.copy(), np.zeros((n, n))
    held = list(fit.ambiguity.folded)
    traded = fit.ambiguity.trades.T @ values[held] if held else np.zeros(n)
    traded[held] = 0.0
    own = values - traded  # what is determined of each parameter: its own value less what a held one stands for
    own[held] = 0.0
    nothing_known = LawNullSpace(columns, equations_gram(trials)).given(())
    spread[np.ix_(fit.free, fit.free)] = fit.covariance
    for factor in nothing_known.factors:
        joints = np.flatnonzero(factor[list(columns.kp)])
        law = [
            [-(rows[:, joints, n_base:n] @ values[n_base:]) for rows in pair]
            for pair in zip(simulated, (e.counted(e.rows[..., :n]) for e in measured), strict=True)
        ]
        torque = [e.counted(e.tau[..., None])[:, joints, 0] for e in measured if e.tau is not None]
        size, variance = _ratio([pair[0] for pair in law], [pair[1] for pair in law], torque)
        part = np.where(factor != 0.0, own, 0.0)
        values += (size - 1.0) * part
        grown = np.where(factor != 0.0, size, 1.0)
        spread = spread * np.outer(grown, grown) + variance * np.outer(part, part)
    free = np.setdiff1d(np.arange(n), held)
    return replace(fit, values=values, free=free, covariance=spread[np.ix_(free, free)])


def _ratio(instrument: Sequence[Floats], law: Sequence[Floats], torque: Sequence[Floats]) -> tuple[float, float]:
    """Return by how much the measured torque exceeds the law's, and the variance of that."""
    cross = sum(float(np.sum(z * x)) for z, x in zip(instrument, law, strict=True))
    if cross == 0.0:
        raise DataError("no joint moved in the trials that have a torque, so it tells no factor")
    size = sum(float(np.sum(z * t)) for z, t in zip(instrument, torque, strict=True)) / cross
    grams, scores, trial = [], [], []
    for number, (z, x, t) in enumerate(zip(instrument, law, torque, strict=True)):
        for part in np.array_split(np.arange(len(z)), min(_BLOCKS, len(z))):
            grams.append(np.sum(z[part] ** 2))
            scores.append(np.sum(z[part] * (t[part] - size * x[part])))
            trial.append(number)
    power = float(np.sum(grams))
    W = np.array([[np.sqrt(power)]])
    plain = sandwich_covariance(
        W, np.reshape(grams, (-1, 1, 1)), np.reshape(scores, (-1, 1)), np.array(trial, dtype=np.intp)
    )
    return size, float(plain[0, 0]) * (power / cross) ** 2
