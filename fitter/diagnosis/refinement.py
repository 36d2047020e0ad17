"""The psi of a model that leave least: Gauss and Newton's way over psi alone.

Base parameters and the columns' factors are solved for at every psi (variable projection, Golub and Pereyra 1973).
Slopes are taken with the noise in the columns as it is: what it adds to the normal equations changes the residual
along the columns only, where next to nothing is left, so its own slope moves no end of the search.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.optimize

from arm.model import Floats
from fitter.diagnosis.attenuation import Noise
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.rows import SLOPE

_ROUNDS, _FEW_ROUNDS = 25, 8
#: A psi of less than this is moved as if it were this large.
_LEAST = 1e-3


def refined(
    regression: Regression, model: Model, motions: Sequence[Motion], held: int = 0, rounds: int | None = None
) -> Model:
    """Return a model with the psi that leave least, or that some rounds of the search for them come to.

    Parameters
    ----------
    regression : Regression
    model : Model
    motions : sequence of Motion
        That it is fitted to.
    held : int
        The psi of so many hypotheses, from the first on, stay.
    rounds : int, optional
        The most; enough unless given.
    """
    free = Model(model.hypotheses[held:], model.psi[held:])
    if not len(free.flat):
        return model
    low = np.concatenate([hypothesis.low for hypothesis in free.hypotheses])
    high = np.concatenate([hypothesis.high for hypothesis in free.hypotheses])
    start = np.clip(free.flat, low + 1e-12, high - 1e-12)
    is_weak = any(hypothesis.kind.name == "gain_error" for hypothesis in model.hypotheses)

    def at(flat: Floats) -> Model:
        return replace(model, psi=(*model.psi[:held], *free.at(flat).psi))

    def left(flat: Floats, noise: Noise | None = None) -> Floats:
        there = at(flat)
        return regression.left(there, regression.solve(there, motions, noise), motions)

    def slopes(flat: Floats) -> Floats:
        here = left(flat)
        noise = None if is_weak else regression.noise(at(flat), motions)  # a gain scales all noise
        columns = []
        for k, value in enumerate(flat):
            step = SLOPE * max(abs(float(value)), _LEAST)
            step = step if value + step <= high[k] else -step
            beside = np.where(np.arange(len(flat)) == k, value + step, flat)
            columns.append((left(beside, noise) - here) / step)
        return np.stack(columns, axis=1)

    found = scipy.optimize.least_squares(
        left,
        start,
        jac=slopes,
        bounds=(low, high),
        x_scale=np.maximum(np.abs(start), 1e-3),
        max_nfev=rounds or (_FEW_ROUNDS if free.is_event else _ROUNDS),
        xtol=1e-5,
        ftol=1e-7,
    )
    return at(found.x)
