r"""Factors of a model that a few blocks of its residual do not bend.

The residual of a joint in a block of a second follows Student's distribution of n dimensions, so a block counts

.. math:: u = (\nu + n) / (\nu + \chi^2 / s^2), \quad s^2 = \sum u \chi^2 / \sum n

in turn with the factors (Lange, Little and Taylor 1989). What moves an arm for a moment has little say then.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.least_squares import BLOCK_S, ITERATIONS, NEGLIGIBLE, TINY
from fitter.diagnosis.mass_density import Normal
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression

#: Degrees of freedom: those that Lange, Little and Taylor find to serve most data.
_DEGREES_OF_FREEDOM = 4.0


def robustly_fitted(regression: Regression, candidate: Candidate) -> Candidate:
    """Return a model with factors fitted robustly to all trials, its psi as they are.

    Parameters
    ----------
    regression : Regression
    candidate : Candidate
        Fitted by least squares.
    """
    model, x = candidate.model, candidate.x
    if regression.density is None or not len(x):
        return candidate
    motions = regression.motions
    rows = [regression.rows(model, motion) for motion in motions]
    designs = [one.design.reshape(*one.target.shape, -1) for one in rows]
    blocks = [_blocks(regression, motion, len(one.target)) for motion, one in zip(motions, rows, strict=True)]
    counts = [np.bincount(block).astype(np.float64)[:, None] for block in blocks]
    numbers, total = float(regression.told.sum()), sum(one.target.size for one in rows)
    variance = np.inf
    for _ in range(ITERATIONS):
        squares = [_in_blocks(one.left(x) ** 2, block) for one, block in zip(rows, blocks, strict=True)]
        weights = [_weights(square, count, variance) for square, count in zip(squares, counts, strict=True)]
        was, summed = variance, sum(float(np.sum(u * square)) for u, square in zip(weights, squares, strict=True))
        variance = max(summed / total, TINY)
        if abs(was - variance) < NEGLIGIBLE * variance:
            break
        parts = zip(designs, (one.target for one in rows), weights, blocks, strict=True)
        normal = _normal([(design, target, u[block]) for design, target, u, block in parts])
        counted = sum(float(np.sum(u * count)) for u, count in zip(weights, counts, strict=True))
        x = regression.density.solve(normal, numbers * counted / total, x, model, motions)
    return replace(candidate, x=x, squares=regression.squares(model, x))


def _blocks(regression: Regression, motion: Motion, n: int) -> NDArray[np.intp]:
    """Return the block that each row of a motion's equations is in, (n,)."""
    n_block = max(1, int(n * regression.weighting.stride * motion.dt_s / BLOCK_S))
    return np.minimum(np.arange(n) * n_block // n, n_block - 1)


def _in_blocks(squares: Floats, block: NDArray[np.intp]) -> Floats:
    """Return the sums of rows (n, n_joint) over blocks, (n_block, n_joint)."""
    sums = np.zeros((int(block[-1]) + 1, squares.shape[1]))
    np.add.at(sums, block, squares)
    return sums


def _weights(squares: Floats, counts: Floats, variance: float) -> Floats:
    """Return how much each block of each joint counts, (n_block, n_joint)."""
    if not np.isfinite(variance):
        return np.ones_like(squares)
    return np.asarray((_DEGREES_OF_FREEDOM + counts) / (_DEGREES_OF_FREEDOM + squares / variance))


def _normal(parts: list[tuple[Floats, Floats, Floats]]) -> Normal:
    """Return the normal equations of weighted rows: of design, target and weights of each motion."""
    gram = sum(np.einsum("rji,rj,rjk->ik", design, u, design, optimize=True) for design, _, u in parts)
    pull = sum(np.einsum("rji,rj->i", design, u * target) for design, target, u in parts)
    square = sum(float(np.sum(u * target**2)) for _, target, u in parts)
    return Normal(np.asarray(gram), np.asarray(pull), square)
