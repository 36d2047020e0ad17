"""What was learnt of an arm's dynamics, and its JSON document."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from fitter.dynamics.evaluation import Score
from fitter.dynamics.torque_problem import TorqueProblem
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import Note, documents

Method = Literal["ga", "least-squares"]
#: What is made small: eq. (9) as printed; with every frequency weighted by its noise; with joints weighted by
#: theirs; with outliers drawn in as well; or the difference between simulated and measured motion.
Objective = Literal["torque", "likelihood", "weighted", "robust", "motion"]


@dataclass(frozen=True)
class DynamicsFit:
    """What was learnt of an arm's dynamics.

    Attributes
    ----------
    arm : Arm
        The arm with what was learnt in ``[base_parameters]``, and links and friction that have these values.
    parameters : mapping from name to FittedParameter
        The base parameters, then the static frictions F, which eq. (8) does not contain.
    method : {"ga", "least-squares"}
    objective : {"torque", "likelihood", "weighted", "robust", "motion"}
    generations, population, samples : int
    seconds : float
    condition_number : float
        Of the columns of the learnt parameters, each scaled to length one.
    cost : float
        Eq. (9) summed over samples and joints.
    base : BaseParameters
    problem : TorqueProblem
        The torque's small least-squares problem: what is free, what is revealed.
    covariance : (n_free, n_free)
        Of the free parameters; NaN where the data is too short for one.
    notes : tuple of Note
        What the user should know of this answer.
    freedom : float
        Degrees of freedom that the covariance was estimated with; NaN where nothing tells the errors.
    """

    arm: Arm
    parameters: Mapping[str, FittedParameter]
    method: Method
    objective: Objective
    generations: int
    population: int
    samples: int
    seconds: float
    condition_number: float
    cost: float
    base: BaseParameters
    problem: TorqueProblem
    covariance: Floats
    notes: tuple[Note, ...] = ()
    freedom: float = np.inf


def document(fit: DynamicsFit, learn: Score | None, evaluate: Score | None = None) -> dict[str, object]:
    """Return the JSON document of ``fitter dynamics``.

    Parameters
    ----------
    fit : DynamicsFit
    learn, evaluate : Score
        Of the calibrated arm on the learning and, where there are any, the evaluating trials.
    """
    scores = {"learn": learn, "evaluate": evaluate}
    return {
        "parameters": {name: parameter.document() for name, parameter in fit.parameters.items()},
        "method": fit.method,
        "generations": fit.generations,
        "samples": fit.samples,
        "seconds": fit.seconds,
        "condition_number": fit.condition_number,
        "torque_rms_N_m": {role: s and list(s.torque_rms_N_m) for role, s in scores.items()},
        "angle_error_deg": {
            role: s and {"mean": s.angle_mean_deg, "max": s.angle_max_deg} for role, s in scores.items()
        },
        "objective": fit.objective,
        "ci95": {name: parameter.ci95 for name, parameter in fit.parameters.items()},
        "angle_rms_deg": {role: s and s.angle_rms_deg for role, s in scores.items()},
        "explained": {role: s and list(s.explained) for role, s in scores.items()},
        "notes": documents(fit.notes),
    }
