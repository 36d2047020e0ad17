"""Dynamic parameters as cells of a table: the paper's, ours with a 95 % interval, and the truth."""

from collections.abc import Mapping, Sequence

import numpy as np

from fitter.dynamics.dynamics_fit import DynamicsFit, Objective
from fitter.report.published import PARAMETERS
from fitter.search.fitted_parameter import FittedParameter
from limbcal.digits import NORMAL_95
from reproduction.experiment import Cell

#: The first four columns of the paper's tables are inertial, the others friction.
INERTIAL, FRICTION = PARAMETERS[:4], PARAMETERS[4:]


def plain_row(labels: Sequence[Cell], values: Sequence[float]) -> tuple[Cell, ...]:
    """Return a row of the paper's, or of the truth: labels, then values that come without an error."""
    return (*labels, *(f"{value:.6f}" for value in values))


def fitted_row(labels: Sequence[Cell], parameters: Mapping[str, FittedParameter]) -> tuple[Cell, ...]:
    """Return a row of ours: labels, then each value with half of its 95 % interval.

    An arm whose axes were found to be askew has other combinations; theirs stay empty.
    """
    return (*labels, *(interval(parameters[name]) if name in parameters else None for name in PARAMETERS))


def method_said(name: str, fit: DynamicsFit, asked: Objective) -> str:
    """Return what a fit is to be called; one that fell back from the motion on the torque says so."""
    return name if fit.objective == asked else f"{name}, came to nothing: {fit.objective}"


def interval(parameter: FittedParameter) -> str:
    """Return a value and half of its 95 % interval; a value that the data did not determine says so."""
    if not parameter.identifiable:
        return "not identified"
    if not np.isfinite(parameter.std):
        return f"{parameter.value:.6f}"
    return f"{parameter.value:.6f} ± {NORMAL_95 * parameter.std:.2g}"


def off_percent(parameters: Mapping[str, FittedParameter], true: Mapping[str, float]) -> dict[str, float]:
    """Return how far each value is from the true one, in percent of it."""
    return {
        name: 100.0 * (parameters[name].value - value) / abs(value) for name, value in true.items() if value != 0.0
    }


def worst_inertial_percent(parameters: Mapping[str, FittedParameter], true: Mapping[str, float]) -> float:
    """Return the largest error among the inertial parameters, in percent of the true one."""
    off = off_percent(parameters, true)
    return max(abs(off[name]) for name in INERTIAL)


def outside(parameters: Mapping[str, FittedParameter], true: Mapping[str, float]) -> list[str]:
    """Return which values have the truth outside of their own 95 % interval."""
    return [
        name
        for name, value in true.items()
        if not abs(parameters[name].value - value) <= NORMAL_95 * parameters[name].std
    ]


def numbers(parameters: Mapping[str, FittedParameter]) -> dict[str, object]:
    """Return value, standard error and identifiability of every column, for JSON."""
    return {name: parameters[name].document() for name in PARAMETERS if name in parameters}
