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
from fitter.diagnosis.least_squares import ITERATIONS, SLOPE
from fitter.diagnosis.model import LEAST_PSI, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression


class Misfit:
    """What a model leaves of some motions' equations, as a function of its psi.

    Parameters
    ----------
    regression : Regression
    model : Model
    motions : sequence of Motion
        That it is fitted to.
    held : int
        The psi of so many hypotheses, from the first on, stay.

    Attributes
    ----------
    low, high, start : (n_psi,)
        Bounds of those that are free, and what the model has, inside them.
    """

    def __init__(self, regression: Regression, model: Model, motions: Sequence[Motion], held: int = 0) -> None:
        self._regression, self._model, self._motions, self._held = regression, model, motions, held
        self._free = Model(model.hypotheses[held:], model.psi[held:])
        self.low = np.concatenate([np.zeros(0), *(one.low for one in self._free.hypotheses)])
        self.high = np.concatenate([np.zeros(0), *(one.high for one in self._free.hypotheses)])
        self.start = np.clip(self._free.flat, self.low + 1e-12, self.high - 1e-12)
        #: A gain scales all noise, so it does not stay as it is.
        self._is_weak = any(hypothesis.is_gain for hypothesis in model.hypotheses)
        self._last: tuple[Floats, Floats] | None = None

    def at(self, flat: Floats) -> Model:
        """Return the model with free psi (n_psi,)."""
        return replace(self._model, psi=(*self._model.psi[: self._held], *self._free.at(flat).psi))

    def left(self, flat: Floats) -> Floats:
        """Return what it leaves there, in units of the noise."""
        if self._last is None or not np.array_equal(self._last[0], flat):
            self._last = flat.copy(), self._left(flat)  # slopes are asked for where it was asked for last
        return self._last[1]

    def slopes(self, flat: Floats) -> Floats:
        """Return by how much that grows with each free psi, (n_row, n_psi)."""
        here = self.left(flat)
        noise = None if self._is_weak else self._regression.noise(self.at(flat), self._motions)
        columns = []
        for k, value in enumerate(flat):
            step = SLOPE * max(abs(float(value)), LEAST_PSI)
            step = step if value + step <= self.high[k] else -step
            column = (self._left(np.where(np.arange(len(flat)) == k, value + step, flat), noise) - here) / step
            columns.append(column if np.all(np.isfinite(column)) else np.zeros_like(here))
        return np.stack(columns, axis=1)

    def _left(self, flat: Floats, noise: Noise | None = None) -> Floats:
        there = self.at(flat)
        return self._regression.all_left(there, self._regression.solve(there, self._motions, noise), self._motions)


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
    misfit = Misfit(regression, model, motions, held)
    if not len(misfit.start) or not np.all(np.isfinite(misfit.left(misfit.start))):
        return model  # where masses vanish no slope leads back
    found = scipy.optimize.least_squares(
        misfit.left,
        misfit.start,
        jac=misfit.slopes,
        bounds=(misfit.low, misfit.high),
        x_scale=np.maximum(np.abs(misfit.start), LEAST_PSI),
        max_nfev=rounds or ITERATIONS,
        xtol=1e-5,
        ftol=1e-7,
    )
    there = misfit.at(found.x)
    inside = zip(there.hypotheses, there.psi, strict=True)
    return replace(there, psi=tuple(hypothesis.inside(psi) for hypothesis, psi in inside))
