"""Causes that are too large to be true: base parameters, or another cause, take away most of what they do.

A spring beside a gravity that stands on its head makes the cube of a small angle, q - sin(q) = q^3 / 6 + …, each
of them many times what the motor gives. Two that cancel are one unknown function, and neither of them.
"""

import numpy as np

from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate

#: No cause makes more than so many times the torque that is measured. The largest that was seen of a true one was
#: 1.4 (a spring that carries its link); what cancelled made 16.
_MOST = 5.0


def is_cancelled(regression: Regression, final: Candidate) -> bool:
    """Say whether some cause of a model makes many times the torque that there is.

    Parameters
    ----------
    regression : Regression
    final : Candidate
    """
    model, x = final.model, final.x
    rows = [regression.rows(model, motion) for motion in regression.motions]
    there_is = sum(float(np.sum(one.target**2)) for one in rows)
    at = len(x) - model.n_column
    for hypothesis in model.hypotheses:
        its = slice(at, at + hypothesis.n_column)
        made = sum(float(np.sum((one.design[:, its] @ x[its]) ** 2)) for one in rows)
        if made > _MOST**2 * there_is:
            return True
        at = its.stop
    return False
