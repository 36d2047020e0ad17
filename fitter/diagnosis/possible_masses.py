"""Base parameters with masses that a body can have, where those of a fitted model are none."""

from collections.abc import Callable

import numpy as np

from arm.model import Floats
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.diagnosis.estimates import generic_arm
from fitter.diagnosis.least_squares import SETTLED
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.regression import Regression
from fitter.dynamics.physical import nominal_links


def possible_base(
    regression: Regression, fitted: Candidate, is_possible: Callable[[Floats], bool], least: float = SETTLED
) -> Floats:
    """Return base parameters with possible masses, between those of a fitted model and of a body, (n_base,).

    Masses are linear in the parameters, and the possible ones are a convex cone. So a straight line from any
    parameters to a body's enters it once. The body is that of the arm file, or of rods, scaled until its torque
    is as large as the measured one; friction stays as it is.

    Parameters
    ----------
    regression : Regression
    fitted : Candidate
    is_possible : callable
        Says whether base parameters have possible masses in all motions.
    least : float
        The least step towards the body; every further one is twice as long.
    """
    arm, model = regression.arm, fitted.model
    hypothetical = regression.hypothetical(model, regression.motions[0])
    base = structural_parameters(generic_arm(arm, hypothetical.arm))
    columns = regression.equations.independent(hypothetical.arm)
    where = [base.independent.index(int(column)) for column in columns]
    standard = np.zeros_like(standard_parameters(arm))
    standard[: 10 * arm.n_joint] = nominal_links(arm).ravel()
    body = (base.combination @ standard)[where]

    rows = [regression.rows(model, motion) for motion in regression.learning]
    gram = np.sum([one.columns.gram[: len(body), : len(body)] for one in rows], axis=0)
    square = sum(float(one.right.gram[0, 0]) for one in rows)
    body *= np.sqrt(square / float(body @ gram @ body))

    start = fitted.x[: len(body)]
    end = np.where(np.asarray(columns) < 10 * arm.n_joint, body, start)
    parts = 0.5 ** np.arange(np.ceil(-np.log2(least)), 0.0, -1.0)
    return next((one for one in (start + part * (end - start) for part in parts) if is_possible(one)), end)
