"""What most trials agree on: what happened in a few of them must not bend what is expected of the rest."""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression

#: Rounds of reweighting.
_ROUNDS = 12
#: A trial stands apart if it is left with so many times what trials are left with in the middle …
_APART = 4.0
#: … and no more than this share of the trials does.
_FEW = 0.15
_DEPENDENT = 1e-12


def agreed(regression: Regression, model: Model) -> Floats:
    """Return the factors that most trials agree on: those with the least sum of logarithms of what is left.

    That is the fit to trials whose noise is of unknown size each, by reweighting (Holland and Welsch 1977).

    Parameters
    ----------
    regression : Regression
    model : Model

    Returns
    -------
    (n_factor,)
    """
    rows = [regression.rows(model, motion) for motion in regression.motions]
    grams = np.array([one.columns.gram for one in rows])
    pulls = np.array([one.pull for one in rows])
    size = np.sqrt(np.einsum("kii->i", grams))
    size[size == 0.0] = 1.0
    grams, pulls = grams / np.outer(size, size), pulls / size
    told = regression.told
    weight = np.ones(len(rows))
    x = np.zeros(len(size))
    for _ in range(_ROUNDS):
        G, pull = np.einsum("k,kij->ij", weight, grams), weight @ pulls
        x = np.linalg.pinv(G, rcond=_DEPENDENT, hermitian=True) @ pull / size
        weight = told / np.maximum(regression.squares(model, x), told)
    return x


def apart(squares: Floats, told: Floats) -> NDArray[np.bool_]:
    """Say which trials stand apart from the others by what is left in them, (n_trial,).

    Parameters
    ----------
    squares, told : (n_trial,)
        What is left in each, and what noise would leave.
    """
    ratio = squares / told
    worst = np.argsort(ratio)[::-1][: int(_FEW * len(ratio))]
    alone = np.zeros(len(ratio), dtype=np.bool_)
    alone[worst] = ratio[worst] > _APART * max(float(np.median(ratio)), 1.0)
    return alone


def typical(squares: Floats, told: Floats) -> float:
    """Return what trials are left with, in units of noise, as their geometric mean: no trial counts for many."""
    return float(np.exp(np.mean(np.log(np.maximum(squares / told, 1e-300)))))


def disagreement(squares: Floats, told: Floats) -> float:
    """Return how much trials are left with on the whole when none of them counts for many, in logarithms."""
    return float(np.sum(np.log(np.maximum(squares / told, 1.0))))
