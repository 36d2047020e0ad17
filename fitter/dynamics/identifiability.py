"""What a motion reveals of an arm: single base parameters, combinations of them, and what it leaves open.

A parameter is compared with its size: its own value, or what would make a hundredth of the torque if it is smaller
than that. It is revealed where its standard error is below a tenth of this. What is not is looked at together: the
principal axes of the common error of those parameters are combinations that are known well or not at all.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from fitter.dynamics.torque_problem import TorqueProblem

Indices = NDArray[np.intp]

#: A parameter counts as at least so large as would make this fraction of the torque.
FELT = 0.01
#: It is revealed if known to this fraction of its size.
KNOWN = 0.1
#: What the data does not determine is known to this many times its size, before any data.
_UNKNOWN = 1e3
#: Parts of a combination below this fraction of its largest are omitted.
_PART = 0.05
#: A column that adds less than this, squared, to the sought ones is not determined by the data.
_NEW_PART = 1e-8


@dataclass(frozen=True)
class Combination:
    """A combination of base parameters, and whether the motion reveals it.

    Attributes
    ----------
    weights : mapping from name to float
        ``sum of weight * parameter``; the weightiest has 1.
    relative_std : float
        Standard error in units of the parameters' sizes; infinite where the data says nothing.
    revealed : bool
    sentence : str
    """

    weights: Mapping[str, float]
    relative_std: float
    revealed: bool
    sentence: str

    def document(self) -> dict[str, object]:
        """Return the combination as it stands in a JSON document."""
        return {
            "combination": dict(self.weights),
            "relative_std": self.relative_std,
            "revealed": self.revealed,
            "sentence": self.sentence,
        }


@dataclass(frozen=True)
class Identifiability:
    """What a motion reveals.

    Attributes
    ----------
    condition_number : float
    combinations : tuple of Combination
        Single parameters that are revealed; then combinations of the others, the best known first.
    """

    condition_number: float
    combinations: tuple[Combination, ...]

    def document(self) -> dict[str, object]:
        """Return the report as it stands in a JSON document."""
        return {
            "condition_number": self.condition_number,
            "combinations": [combination.document() for combination in self.combinations],
        }

    def sentences(self) -> list[str]:
        """Return what to say to a person: what is revealed only together, and what is not."""
        return [c.sentence for c in self.combinations if not c.revealed or len(c.weights) > 1]


def report(
    arm: Arm, base: BaseParameters, problem: TorqueProblem, values: Floats | None = None
) -> Identifiability:
    """Say which combinations of base parameters a motion reveals.

    Parameters
    ----------
    arm : Arm
    base : BaseParameters
    problem : TorqueProblem
        Parameters that were held on purpose are omitted; what is said of the others holds given them.
    values : (n_base,), optional
        Where errors and sizes are taken; the least-squares answer by default.

    Returns
    -------
    Identifiability
    """
    values = problem.complete(problem.optimum()) if values is None else values
    gram = problem.sums.gram.sum(axis=(0, 1))
    undetermined, dependence = _dependent(gram, problem.free)
    sought = np.concatenate([problem.free, undetermined]).astype(np.intp)
    size = _sizes(problem, gram, values)[sought]
    covariance = _covariance(problem, values, dependence, size)
    std = np.sqrt(np.diag(covariance))
    names = [base.names[k] for k in sought]

    order = np.argsort(sought)
    single = [_combination(names, np.eye(len(sought))[k], size, float(std[k])) for k in order if std[k] < KNOWN]
    vague = np.array([k for k in order if std[k] >= KNOWN], dtype=np.intp)
    together: list[Combination] = []
    if len(vague):
        variance, axes = np.linalg.eigh(covariance[np.ix_(vague, vague)])
        for spread, axis in zip(np.sqrt(np.maximum(variance, 0.0)), axes.T, strict=True):
            direction = np.zeros(len(sought))
            direction[vague] = axis
            hidden = _behind_constants(arm, base, problem, sought[vague], axis)
            together.append(_combination(names, direction, size, float(spread), hidden))
    return Identifiability(problem.condition_number, (*single, *together))


def _dependent(gram: Floats, free: Indices) -> tuple[Indices, Floats]:
    """Return the columns that depend on the free ones, and how: ``column = free columns @ dependence``."""
    others = np.setdiff1d(np.arange(len(gram)), free)
    scale = np.sqrt(np.diag(gram))
    scale = np.where(scale > 0.0, scale, 1.0)
    unit = gram / np.outer(scale, scale)
    weights = np.linalg.solve(unit[np.ix_(free, free)], unit[np.ix_(free, others)])
    independent_part = np.diag(unit)[others] - np.einsum("fo,fo->o", weights, unit[np.ix_(free, others)])
    undetermined = independent_part <= _NEW_PART
    return others[undetermined], weights[:, undetermined] * scale[others[undetermined]] / scale[free][:, None]


def _sizes(problem: TorqueProblem, gram: Floats, values: Floats) -> Floats:
    """Return each parameter's value, or what makes a share of the torque of the joints that feel it."""
    power = np.einsum("bj,bja->a", problem.sums.power, np.einsum("bjaa->bja", problem.sums.gram) > 0.0)
    felt = np.diag(gram)
    least = np.where(felt > 0.0, FELT * np.sqrt(power / np.where(felt > 0.0, felt, 1.0)), 0.0)
    size = np.maximum(np.abs(values), least)
    return np.where(size > 0.0, size, 1.0)


def _covariance(problem: TorqueProblem, values: Floats, dependence: Floats, size: Floats) -> Floats:
    """Return the covariance of the free and the untold parameters in units of their sizes.

    What is determined is ``free + dependence @ undetermined``; of the undetermined ones hardly anything is known.
    """
    n = len(problem.free)
    learnt = problem.covariance(values)
    if not np.isfinite(learnt).all():  # too few blocks: white noise is the best guess
        learnt = problem.inverse * problem.rest / max(float(problem.sums.count.sum()) - n, 1.0)
    mix = np.vstack([-dependence, np.eye(dependence.shape[1])]) * size[n:]
    covariance = _UNKNOWN**2 * mix @ mix.T
    covariance[:n, :n] += learnt
    return np.asarray(covariance / np.outer(size, size), dtype=np.float64)


def _behind_constants(
    arm: Arm, base: BaseParameters, problem: TorqueProblem, columns: Indices, axis: Floats
) -> str | None:
    """Say where Coulomb friction cannot be distinguished from a constant torque that each trial was given.

    Where a joint moves, the square of a velocity's sign is 1; its column can only have vanished with the trial's
    mean, because the velocity never changed sign in any.
    """
    k = int(columns[np.argmax(np.abs(axis))])
    joint = base.independent[k] - 11 * arm.n_joint
    moved = joint >= 0 and float(problem.sums.count[:, joint].sum()) > 0.0
    if moved and not np.any(problem.sums.gram[:, joint, k, k]):
        return f"{base.names[k]} is revealed only together with a constant torque of joint {joint + 1}"
    return None


def _combination(
    names: list[str], direction: Floats, size: Floats, relative: float, hidden: str | None = None
) -> Combination:
    lead = int(np.argmax(np.abs(direction)))
    parts = np.flatnonzero(np.abs(direction) >= _PART * np.abs(direction[lead]))
    parts = np.concatenate([[lead], parts[parts != lead]])
    weight = direction / size * (size[lead] / direction[lead])
    weights = {names[k]: float(weight[k]) for k in parts}
    revealed = relative < KNOWN
    undetermined = relative > 0.1 * _UNKNOWN
    relative = np.inf if undetermined else relative
    text = _written(weights)
    if revealed:
        sentence = f"{text} is revealed, to {relative:.2g} of its size"
        if len(parts) > 1:
            sentence += f", but {_listed([names[k] for k in parts])} not one by one"
    elif hidden is not None:
        sentence = f"{hidden}, which never turned round within a trial"
    else:
        known = "not at all" if undetermined else f"only to {relative:.2g} of its size"
        sentence = f"{text} is revealed {known}"
    return Combination(weights, float(relative), revealed, sentence)


def _written(weights: Mapping[str, float]) -> str:
    """Return a combination as a formula."""
    text = ""
    for name, weight in weights.items():
        whole = f"({name})" if len(weights) > 1 and ("+" in name or "-" in name) else name
        factor = whole if np.isclose(abs(weight), 1.0) else f"{abs(weight):.3g} {whole}"
        sign = ("-" if weight < 0 else "") if not text else (" - " if weight < 0 else " + ")
        text += sign + factor
    return text


def _listed(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
