"""A base that moves in any way: what its acceleration was, and what its freedom costs."""

import numpy as np

from arm.model import Floats
from fitter.reading_diagnosis.linearisation import Linearisation
from fitter.reading_diagnosis.sensor_hypotheses import Fitted
from fitter.reading_diagnosis.trial_equations import Trials


def base_course(trials: Trials, fitted: Fitted, number: int) -> Floats:
    """Return the acceleration of the base along the fitted motion of a trial, (n, 3) [m/s^2]."""
    return _course(trials, fitted, number)[0]


def freedom(trials: Trials, fitted: Fitted, number: int) -> float:
    """Return what the freedom of a base costs in a trial, squared and in units of the noise; 0 for a base at rest.

    Three numbers a frame of variance b^2, their mean square, cost ``e^2 / b^2 + log(1 + b^2 F' F)`` each, with F
    what the sensors feel of them: minus twice the logarithm of their evidence (Laplace), eq. (m.4).
    """
    if not fitted.hypothesis.free_base:
        return 0.0
    base, at = _course(trials, fitted, number)
    felt = at.from_base() * at.weight[..., None]
    information = np.einsum("kcx,kcy->kxy", felt, felt)
    _, volume = np.linalg.slogdet(np.eye(3) + information * np.mean(base**2, axis=0))
    return float(base.size + volume.sum())


def _course(trials: Trials, fitted: Fitted, number: int) -> tuple[Floats, Linearisation]:
    hypothesis, motion = fitted.hypothesis, fitted.motions[number]
    at = trials.linearised(number, hypothesis, motion)
    return trials.walked(number, at, hypothesis, motion)[:, -3:], at
