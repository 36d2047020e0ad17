"""Errors that stay for a whole motion are seen by comparing motions."""

import numpy as np

from fitter.search.clusters import covariance_by_motions
from fitter.search.standard_errors import sandwich_covariance


def fitted(rng, motions=6, blocks=40):
    """Return what a fit of a slope leaves where each motion has an error of its own."""
    A = rng.normal(1.0, 0.2, (motions, blocks, 20))
    b = A * 2.0 + rng.normal(0.0, 0.1, (motions, 1, 1)) + rng.normal(0.0, 0.01, A.shape)
    x = np.sum(A * b) / np.sum(A**2)
    grams = (A**2).sum(axis=2).reshape(-1, 1, 1)
    scores = (A * (b - A * x)).sum(axis=2).reshape(-1, 1)
    return x, np.array([[np.sqrt(np.sum(A**2))]]), grams, scores, np.repeat(np.arange(motions), blocks)


def test_intervals_hold_what_blocks_do_not_see():
    rng, by_motions, by_blocks = np.random.default_rng(0), [], []
    for _ in range(300):
        x, *sums = fitted(rng)
        covariance, freedom = covariance_by_motions(*sums)
        assert freedom == 5.0
        by_motions.append((x - 2.0) / np.sqrt(covariance[0, 0]))
        by_blocks.append((x - 2.0) / np.sqrt(sandwich_covariance(*sums)[0, 0]))
    assert np.mean(np.abs(by_motions) < 2.571) > 0.9  # Student's 97.5 % with five degrees of freedom
    assert np.mean(np.abs(by_blocks) < 1.96) < 0.9


def test_a_single_motion_tells_nothing_of_itself():
    _, W, grams, scores, _ = fitted(np.random.default_rng(0), motions=1)
    covariance, freedom = covariance_by_motions(W, grams, scores, np.zeros(len(grams), dtype=np.intp))
    assert np.isnan(covariance).all() and np.isnan(freedom)
