"""The covariance of an answer by motions: what stays wrong for a whole motion counts once a motion.

A tracker's angles drift, and what drifts is as wrong at the end of a motion as its beginning made it. Blocks of
samples within a motion then have no new information; motions do, and there are few. What the scatter of a few
numbers shows of their spread follows Student's distribution, with one degree of freedom fewer than motions.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats

#: A motion that says nearly all there is of a parameter leaves no residual to correct.
_LARGEST_SHARE = 0.99


def covariance_by_motions(
    W: Floats, grams: Floats, scores: Floats, group: NDArray[np.intp]
) -> tuple[Floats, float]:
    """Return the covariance of a least-squares answer, and its degrees of freedom.

    Parameters
    ----------
    W : (n_parameter, n_parameter)
        Any square root of the normal matrix, ``W^T W = A^T A``.
    grams : (n_block, n_parameter, n_parameter)
        ``A^T A`` of each block of samples.
    scores : (n_block, n_parameter)
        ``A^T r`` at the answer, of each block.
    group : (n_block,) int
        Which motion a block belongs to.

    Returns
    -------
    (n_parameter, n_parameter), float
        NaN where there is only one motion.
    """
    motion = np.unique(group, return_inverse=True)[1]
    n_motion = int(motion.max(initial=-1)) + 1
    if n_motion < 2 or not len(W):
        return np.full_like(W, np.nan), np.nan
    whole_gram, whole_score = np.zeros((n_motion, *W.shape)), np.zeros((n_motion, len(W)))
    np.add.at(whole_gram, motion, grams)
    np.add.at(whole_score, motion, scores)
    root = np.linalg.inv(W)
    # The answer bends towards a motion that says much; (1 - H)^-1/2 undoes this (Bell, McCaffrey 2002).
    share, axes = np.linalg.eigh(root.T @ whole_gram @ root)
    along = np.einsum("bki,bk->bi", axes, whole_score @ root) / np.sqrt(1.0 - np.clip(share, 0.0, _LARGEST_SHARE))
    influences = np.einsum("bki,bi->bk", axes, along) @ root.T
    covariance: Floats = influences.T @ influences * n_motion / (n_motion - 1.0)
    return covariance, n_motion - 1.0
