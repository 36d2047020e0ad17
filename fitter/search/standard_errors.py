"""Standard errors that stay honest when neighbouring residuals resemble each other.

At kilohertz rates they always do, and the textbook ``sigma^2 (A^T A)^-1`` is then too small by a factor of
ten and more. Here the scatter of the scores ``A^T r`` is measured rather than assumed: the scores are summed
over blocks of consecutive samples, and the sums of neighbouring blocks may be correlated too (Newey and West
1987, with the bandwidth of Andrews 1991). Noise whose strength varies with the motion is covered as well.
Not covered is what shifts the answer instead of scattering it: noise in the regressors, missing physics.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats

#: Greatest correlation of neighbouring blocks that is used.
_STRONGEST = 0.97
#: A block that says nearly all there is of a parameter leaves no residual to correct.
_LARGEST_SHARE = 0.99


def sandwich_covariance(
    W: Floats, grams: Floats, scores: Floats, group: NDArray[np.intp], centred: bool = False
) -> Floats:
    """Return the covariance of a least-squares answer.

    Parameters
    ----------
    W : (n_parameter, n_parameter)
        Any square root of the normal matrix, ``W^T W = A^T A``.
    grams : (n_block, n_parameter, n_parameter)
        ``A^T A`` of each block of consecutive samples.
    scores : (n_block, n_parameter)
        ``A^T r`` at the answer, of each block.
    group : (n_block,) int
        Blocks of different trials are independent; blocks of one trial follow one another in time.
    centred : bool
        Whether what the blocks of a trial share is left out: how far trials would then disagree.

    Returns
    -------
    (n_parameter, n_parameter)
        NaN where there are too few blocks.
    """
    n_block, n_parameter = scores.shape
    if n_block < 2 * n_parameter or n_parameter == 0:
        return np.full_like(W, np.nan)
    root = np.linalg.inv(W)
    # The answer bends towards a block that says much, which makes its residuals too small. In coordinates in
    # which A^T A is the identity a block's part of it is H; (1 - H)^-1/2 undoes this (Bell, McCaffrey 2002).
    share, axes = np.linalg.eigh(root.T @ grams @ root)
    along = np.einsum("bki,bk->bi", axes, scores @ root) / np.sqrt(1.0 - np.clip(share, 0.0, _LARGEST_SHARE))
    influences = np.einsum("bki,bi->kb", axes, along)  # how far each block pulls the answer
    if centred:
        trial = np.unique(group, return_inverse=True)[1]
        sums = np.array([np.bincount(trial, row) for row in influences])
        influences = influences - (sums / np.bincount(trial))[:, trial]
    scatter = influences @ influences.T
    lags = _bandwidth(influences, group)
    for lag in range(1, lags + 1):
        together = group[lag:] == group[:-lag]
        product = influences[:, lag:][:, together] @ influences[:, :-lag][:, together].T
        scatter += (1.0 - lag / (lags + 1.0)) * (product + product.T)
    return np.asarray(root @ scatter @ root.T, dtype=np.float64)


def _bandwidth(series: Floats, group: NDArray[np.intp]) -> int:
    """Return how many lags to take in: Andrews' rule for Bartlett weights, from an AR(1) in each row."""
    together = group[1:] == group[:-1]
    n_pair = int(np.count_nonzero(together))
    if n_pair < 2:
        return 0
    power = np.sum(series[:, :-1][:, together] ** 2, axis=1)
    seen = power > 0.0
    if not np.any(seen):
        return 0
    product = np.sum(series[:, 1:][:, together] * series[:, :-1][:, together], axis=1)
    rho = np.clip(product[seen] / power[seen], -_STRONGEST, _STRONGEST)
    alpha = np.mean(4.0 * rho**2 / (1.0 - rho**2) ** 2)
    longest = int(np.max(np.bincount(np.unique(group, return_inverse=True)[1]))) - 1
    return int(min(np.ceil(1.1447 * (alpha * n_pair) ** (1.0 / 3.0)), longest // 2))
