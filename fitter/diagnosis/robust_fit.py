"""Factors that what moves an arm for a moment does not bend: blocks weighted by Student's distribution."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.evidence import blocks_of
from fitter.diagnosis.least_squares import ITERATIONS, NEGLIGIBLE, TINY, Normal
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.regression import Regression


def robustly_fitted(regression: Regression, candidate: Candidate) -> Candidate:
    r"""Return a model with factors fitted robustly to all trials, its psi as they are.

    The residual of a joint in a block of a second follows Student's distribution of n dimensions, so a block
    counts ``u = (nu + n) / (nu + chi^2 / s^2)`` with ``s^2 = sum u chi^2 / sum n``, in turn with the factors
    (Lange, Little and Taylor 1989). What moves an arm for a moment has little say then.

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
    stride = regression.weighting.stride
    blocks = [blocks_of(len(one.target), stride * motion.dt_s) for motion, one in zip(motions, rows, strict=True)]
    counts = [np.bincount(block).astype(np.float64)[:, None] for block in blocks]
    numbers, total = float(regression.n_effective.sum()), sum(one.target.size for one in rows)
    variance = np.inf
    for _ in range(ITERATIONS):
        squares = [_in_blocks(one.residual(x) ** 2, block) for one, block in zip(rows, blocks, strict=True)]
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


def _in_blocks(squares: Floats, block: NDArray[np.intp]) -> Floats:
    """Return the sums of rows (n, n_joint) over blocks, (n_block, n_joint)."""
    sums = np.zeros((int(block[-1]) + 1, squares.shape[1]))
    np.add.at(sums, block, squares)
    return sums


def _weights(squares: Floats, counts: Floats, variance: float, freedom: float = 4.0) -> Floats:
    """Return how much each block of each joint counts by Student's likelihood, (n_block, n_joint).

    With 4 degrees of freedom it hardly loses anything to a normal one, and is not misled (Lange et al. 1989).
    """
    if not np.isfinite(variance):
        return np.ones_like(squares)
    return np.asarray((freedom + counts) / (freedom + squares / variance))


def _normal(parts: list[tuple[Floats, Floats, Floats]]) -> Normal:
    """Return the normal equations of weighted rows: of design, target and weights of each motion."""
    gram = sum(np.einsum("rji,rj,rjk->ik", design, u, design, optimize=True) for design, _, u in parts)
    rhs = sum(np.einsum("rji,rj->i", design, u * target) for design, target, u in parts)
    square = sum(float(np.sum(u * target**2)) for _, target, u in parts)
    return Normal(np.asarray(gram), np.asarray(rhs), square)
