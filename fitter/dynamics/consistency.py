"""A fit held against what masses and friction can be: warned of, or made possible."""

from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.physical import Violation, physical_optimum, violations
from fitter.dynamics.torque_problem import TorqueProblem, torque_problem
from fitter.dynamics.torque_search import assembled
from limbcal.errors import NotConverged
from limbcal.note import Note


def with_warnings(fit: DynamicsFit) -> DynamicsFit:
    """Return the fit with a note for each parameter that no arm can have, and that its error does not explain."""
    try:
        found = [violation.sentence for violation in _violations(fit) if not violation.within_error]
    except NotConverged as error:
        found = [str(error)]
    return replace(fit, notes=(*fit.notes, *(Note("impossible", sentence) for sentence in found)))


def made_possible(fit: DynamicsFit) -> DynamicsFit:
    """Return the best fit among the arms that can exist, by the same objective.

    A fit of the simulated motion is taken as its normal equations around the free answer: the parameters that are
    possible and nearest to it, in units of how well each is known.
    """
    found = _violations(fit)
    if not found:
        return fit
    problem = _motion_problem(fit) if fit.objective == "motion" else fit.problem
    genes, arm = physical_optimum(fit.arm, fit.base, problem)
    fit = assembled(fit, genes)
    possible = replace(arm, base_parameters=fit.arm.base_parameters)
    notes = []
    for within_error, kind, why in ((False, "impossible", ""), (True, "moved", ", within their errors")):
        moved = ", ".join(f"{v.name} from {v.value:.4g}" for v in found if v.within_error == within_error)
        if moved:
            notes.append(Note(kind, f"moved to what masses and friction can be{why}: {moved}"))
    return replace(fit, arm=possible, notes=(*fit.notes, *notes))


def _violations(fit: DynamicsFit) -> list[Violation]:
    values, n = _values(fit), len(fit.base.names)
    covariance = np.full((n, n), np.nan)
    covariance[np.ix_(fit.problem.free, fit.problem.free)] = fit.covariance
    return violations(fit.arm, fit.base, values, covariance)


def _values(fit: DynamicsFit) -> Floats:
    return np.array([fit.parameters[name].value for name in fit.base.names])


def _motion_problem(fit: DynamicsFit) -> TorqueProblem:
    """Return the small problem whose optimum is the fit and whose curvature is what is known of it."""
    free, values = fit.problem.free, _values(fit)
    n = len(values)
    information = np.zeros((1, 1, n, n))
    information[0, 0][np.ix_(free, free)] = np.linalg.inv(fit.covariance)
    moment = information[0] @ values
    sums = replace(
        fit.problem.sums.total(),
        gram=information,
        moment=moment.reshape(1, 1, n),
        power=np.array([[float(values @ information[0, 0] @ values) + fit.samples]]),
        row=np.zeros((1, 1, n)),
        torque=np.zeros((1, 1)),
        count=np.full((1, 1), float(fit.samples)),
    )
    held = {k: float(values[k]) for k in range(n) if k not in set(free.tolist())}
    return torque_problem(sums, values, held)
