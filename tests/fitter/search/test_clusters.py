"""Errors that stay for a whole motion are seen by comparing motions."""

import numpy as np
from scipy.special import stdtrit

from fitter.search.clusters import covariance_by_motions, covariance_of_motions, motion_notes
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


def shared(rng, size, motions=5, blocks=40):
    """Return a fit of two slopes, and how far off it is, where motions share an error of this size."""
    A = rng.normal(1.0, 0.5, (motions * blocks, 20, 2))
    group = np.repeat(np.arange(motions), blocks)
    b = rng.normal(0.0, 0.1, A.shape[:2]) + rng.normal(0.0, size, motions)[group, None]
    rows = A.reshape(-1, 2)
    x = np.linalg.lstsq(rows, b.ravel(), rcond=None)[0]
    grams, scores = np.einsum("bni,bnj->bij", A, A), np.einsum("bni,bn->bi", A, b - A @ x)
    sums = np.linalg.qr(rows).R, grams, scores, group
    return x, (sandwich_covariance(*sums), *sums)


def test_samples_are_the_unit_where_motions_agree():
    rng = np.random.default_rng(1)
    freedom = [covariance_of_motions(*shared(rng, 0.0)[1], tracked=False)[1] for _ in range(200)]
    assert np.mean(np.isinf(freedom)) > 0.9


def test_motions_are_the_unit_where_they_disagree():
    rng, held = np.random.default_rng(2), []
    for _ in range(200):
        x, sums = shared(rng, 0.1)
        covariance, freedom = covariance_of_motions(*sums, tracked=False)
        reach = stdtrit(freedom, 0.975) if np.isfinite(freedom) else 1.96
        held.append(np.abs(x) < reach * np.sqrt(np.diag(covariance)))
    assert np.mean(held) > 0.92


def test_tracked_motions_are_known_no_better_than_either_says():
    rng = np.random.default_rng(3)
    for size in (0.0, 0.1):
        _, sums = shared(rng, size, motions=2)
        covariance, freedom = covariance_of_motions(*sums, tracked=True)
        assert freedom == 1.0
        for less in (sums[0], covariance_by_motions(*sums[1:])[0]):
            assert np.linalg.eigvalsh(covariance - less).min() > -1e-12


def test_one_tracked_motion_has_no_error_another_has_its_samples():
    _, sums = shared(np.random.default_rng(4), 0.0, motions=1)
    assert np.isnan(covariance_of_motions(*sums, tracked=True)[1])
    covariance, freedom = covariance_of_motions(*sums, tracked=False)
    assert np.array_equal(covariance, sums[0]) and np.isinf(freedom)


def test_what_few_motions_cannot_tell_is_said():
    assert "one tracked motion" in motion_notes(np.nan)[0].text
    assert "two motions" in motion_notes(1.0)[0].text
    assert motion_notes(4.0) == motion_notes(np.inf) == ()
