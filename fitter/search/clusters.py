"""The covariance of an answer by motions: what stays wrong for a whole motion counts once a motion.

A tracker's angles drift, and what drifts is as wrong at the end of a motion as its beginning made it. Blocks of
samples within a motion then have no new information; motions do, and there are few. What the scatter of a few
numbers shows of their spread follows Student's distribution, with one degree of freedom fewer than motions.

What was measured sample by sample has errors of which each block has its own, and blocks are many. There motions
are the unit only if they contradict one another by more than their blocks allow.
"""

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.linalg import pinvh

from arm.model import Floats
from fitter.search.standard_errors import sandwich_covariance
from limbcal.note import Note

#: Motions disagree if their blocks would make them do so, or more so, with a probability below this.
_CHANCE = 0.05
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


def covariance_of_motions(
    within: Floats, W: Floats, grams: Floats, scores: Floats, group: NDArray[np.intp], tracked: bool
) -> tuple[Floats, float]:
    r"""Return the covariance of a least-squares answer from blocks and motions, and its degrees of freedom.

    With :math:`A` the covariance by blocks and :math:`B` that by motions, both in coordinates in which the normal
    matrix is the identity, it is :math:`A + (B - A)_+`: what blocks say, and what motions share beside it, which
    is nowhere below zero.

    Parameters
    ----------
    within : (n_parameter, n_parameter)
        By blocks within motions, see `fitter.search.standard_errors`; NaN where these are too few.
    W, grams, scores, group
        See `covariance_by_motions`.
    tracked : bool
        Whether a tracker made the motions: its errors last for a whole motion. Otherwise motions count where they
        disagree by more than blocks allow, by Cochran's Q.

    Returns
    -------
    (n_parameter, n_parameter), float
        NaN where it takes motions and there is only one; infinite freedom where blocks are the unit.
    """
    between, freedom = covariance_by_motions(W, grams, scores, group)
    blocks_tell = bool(np.all(np.isfinite(within)))
    if not tracked and (np.isnan(freedom) or not blocks_tell):
        return within, np.inf
    if np.isnan(freedom) or not blocks_tell:
        return between, freedom
    if not tracked and not _disagree(sandwich_covariance(W, grams, scores, group, centred=True), between, freedom):
        return within, np.inf
    size, axes = np.linalg.eigh(W @ (between - within) @ W.T)
    root = np.linalg.inv(W)
    shared: Floats = root @ (axes * np.maximum(size, 0.0)) @ axes.T @ root.T
    return within + shared, freedom


def motion_notes(freedom: float) -> tuple[Note, ...]:
    """Return what the user should know of intervals that motions, not samples, tell.

    Parameters
    ----------
    freedom : float
        As `covariance_of_motions` returns it: NaN for one tracked motion, infinite where blocks are the unit.
    """
    if np.isnan(freedom):
        return (
            Note(
                "short",
                "one tracked motion alone does not tell how far off the answer is, since its samples share the "
                "tracker's drift; no error is stated, expected several motions",
            ),
        )
    if freedom > 1.0:
        return ()
    return (
        Note(
            "short",
            "two motions can hardly tell how far off the answer is: the intervals have one degree of freedom, and "
            "what is wrong in both motions alike is not in them; expected five motions or more",
        ),
    )


def _disagree(blocks: Floats, motions: Floats, freedom: float) -> bool:
    """Whether motions contradict one another by more than their blocks allow: Cochran's Q of all parameters."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(blocks), np.finfo(float).tiny))
    apart = np.trace(pinvh(blocks * np.outer(scale, scale)) @ (motions * np.outer(scale, scale)))
    return bool(scipy.stats.chi2.sf(apart * freedom**2 / (freedom + 1.0), freedom * len(blocks)) < _CHANCE)
