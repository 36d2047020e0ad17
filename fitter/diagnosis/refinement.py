"""The psi of a model that leave least: Gauss and Newton's way over psi alone.

Base parameters and the columns' factors are solved for at every psi (variable projection, Golub and Pereyra 1973).
Slopes are taken with the noise in the columns as it is: what it adds to the normal equations changes the residual
along the columns only, where next to nothing is left, so its own slope moves no end of the search. It begins where
others have come to, or at the residual's spectral peaks.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from arm.model import Floats
from fitter.diagnosis.errors_in_variables import Noise
from fitter.diagnosis.least_squares import (
    ITERATIONS,
    N_REFINED,
    SLOPE,
    scaled_lstsq,
)
from fitter.diagnosis.model import LEAST_PSI, Candidate, Hypothesis, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.whitening import Whitening


def fitted(
    regression: Regression, model: Model, refine: bool = True, held: int = 0, to_all: bool = False
) -> Candidate:
    """Return a model fitted to the learning trials, with its chi2 in all trials.

    Parameters
    ----------
    regression : Regression
    model : Model
    refine : bool
        Whether psi is sought, too.
    held : int
        Number of hypotheses, from the first on, whose psi is fixed.
    to_all : bool
        Whether it is fitted to all trials, as a model with an event always is.
    """
    motions = regression.motions if to_all else regression.motions_of(model)
    if refine:
        model = refined(regression, model, motions, held)
    x = regression.solve(model, motions)
    return Candidate(model, x, regression.squares(model, x))


def by_learning(regression: Regression, candidate: Candidate) -> Candidate:
    """Return a model with factors fitted to the learning trials, as every model without an event has.

    Factors that have no effect in the learning trials are fitted to the others.
    """
    model = candidate.model
    x = regression.solve(model, regression.learning)
    grams = [regression.rows(model, motion).columns.gram for motion in regression.learning]
    unseen = np.all([np.diag(one) == 0.0 for one in grams], axis=0)
    judging = [motion for motion in regression.motions if not motion.learn]
    if np.any(unseen) and judging:
        rows = [regression.rows(model, motion) for motion in judging]
        residual = [one.target.ravel() - one.design @ np.where(unseen, 0.0, x) for one in rows]
        x[unseen] = scaled_lstsq(np.vstack([one.design[:, unseen] for one in rows]), np.concatenate(residual))
    return replace(candidate, x=x, squares=regression.squares(model, x))


class Misfit:
    """What a model leaves of some motions' equations, as a function of its psi.

    Parameters
    ----------
    regression : Regression
    model : Model
    motions : sequence of Motion
        That it is fitted to.
    held : int
        Number of hypotheses, from the first on, whose psi is fixed.

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

    def residual(self, flat: Floats) -> Floats:
        """Return the residual there, in units of the noise."""
        if self._last is None or not np.array_equal(self._last[0], flat):
            self._last = flat.copy(), self._residual(flat)  # slopes are asked for where it was asked for last
        return self._last[1]

    def slopes(self, flat: Floats) -> Floats:
        """Return by how much that grows with each free psi, (n_row, n_psi)."""
        here = self.residual(flat)
        noise = None if self._is_weak else self._regression.noise(self.at(flat), self._motions)
        columns = []
        for k, value in enumerate(flat):
            step = SLOPE * max(abs(float(value)), LEAST_PSI)
            step = step if value + step <= self.high[k] else -step
            column = (self._residual(np.where(np.arange(len(flat)) == k, value + step, flat), noise) - here) / step
            columns.append(column if np.all(np.isfinite(column)) else np.zeros_like(here))
        return np.stack(columns, axis=1)

    def _residual(self, flat: Floats, noise: Noise | None = None) -> Floats:
        there = self.at(flat)
        return self._regression.residuals_with_limits(
            there, self._regression.solve(there, self._motions, noise), self._motions
        )


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
        Number of hypotheses, from the first on, whose psi is fixed.
    rounds : int, optional
        The most; enough unless given.
    """
    misfit = Misfit(regression, model, motions, held)
    if not len(misfit.start) or not np.all(np.isfinite(misfit.residual(misfit.start))):
        return model  # where masses vanish no slope leads back
    found = scipy.optimize.least_squares(
        misfit.residual,
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


class Starts:
    """Values of psi from which a search has come far: when the same is sought anew, it begins there.

    Where only weights have changed, or the psi of what was accepted, the best of them has hardly moved.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[frozenset[Hypothesis], Hypothesis], Floats] = {}

    def of(self, model: Model, hypothesis: Hypothesis) -> Floats | None:
        """Return those of a hypothesis added to a model, (n_start, n_psi); None if it was not tried there."""
        return self._known.get((frozenset(model.hypotheses), hypothesis))

    def keep(self, model: Model, hypothesis: Hypothesis, starts: Floats) -> None:
        """Keep those that did best."""
        self._known[frozenset(model.hypotheses), hypothesis] = starts

    def forget(self) -> None:
        """Forget all: they are of other trials."""
        self._known.clear()


def peaks(residual: Floats, motions: Sequence[Motion], whitening: Whitening) -> Floats:
    """Return the frequencies at which residuals swing most, (n_peak, 1) [Hz].

    Parameters
    ----------
    left : (n_slower of all motions,)
        Of one joint, one motion after the other.
    motions : sequence of Motion
    whitening : Whitening
        Says what the slower grid is.
    """
    stride = whitening.stride
    ends = np.cumsum([0, *(len(motion.t[::stride]) for motion in motions)])
    span = float(motions[-1].t[-1] - motions[0].t[0])
    f = np.arange(0.05, whitening.band_hz, 0.25 / span)
    swing = np.zeros(len(f), dtype=np.complex128)
    for motion, first, last in zip(motions, ends, ends[1:], strict=False):
        # A chirp transform: as fine as all trials together resolve frequencies, at their own times.
        spectrum = scipy.signal.zoom_fft(
            residual[first:last], [f[0], f[-1]], len(f), fs=1.0 / (stride * motion.dt_s), endpoint=True
        )
        swing += np.exp(-2j * np.pi * f * motion.t[0]) * spectrum
    power = np.abs(swing)
    found: list[float] = []
    for k in np.argsort(power)[::-1]:
        if all(abs(f[k] - other) > 1.0 / span for other in found):
            found.append(float(f[k]))
        if len(found) == N_REFINED:
            break
    return np.array(found)[:, None]
