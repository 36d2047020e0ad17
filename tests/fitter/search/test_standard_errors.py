"""Standard errors against the scatter of many answers."""

import numpy as np
import pytest
from scipy.signal import lfilter

from fitter.search.standard_errors import sandwich_covariance


@pytest.mark.parametrize("memory", [0.0, 0.99])
def test_matches_the_scatter_of_the_answers(memory):
    """Five trials of 2000 samples, slowly changing regressors, noise that remembers 0 or 100 samples."""
    rng = np.random.default_rng(0)
    n, block = 2000, 25
    trial = np.repeat(np.arange(5), n // block)
    t = np.arange(5 * n)
    A = np.column_stack([np.sin(t / 300), np.cos(t / 170), np.ones(5 * n)])
    blocks = A.reshape(-1, block, 3)
    W, inverse = np.linalg.qr(A).R, np.linalg.inv(A.T @ A)
    answers, errors = [], []
    for _ in range(200):
        noise = lfilter([np.sqrt(1 - memory**2)], [1, -memory], rng.normal(size=(5, n + 500)), axis=1)[
            :, 500:
        ].ravel()
        answers.append(inverse @ A.T @ noise)
        residual = (noise - A @ answers[-1]).reshape(-1, block, 1)
        scores = np.sum(blocks * residual, axis=1)
        errors.append(np.diag(sandwich_covariance(W, np.swapaxes(blocks, 1, 2) @ blocks, scores, trial)))
    ratio = np.sqrt(np.mean(errors, axis=0)) / np.std(answers, axis=0)
    assert np.all((ratio > 0.7) & (ratio < 1.2))
    plain = np.sqrt(np.diag(inverse)) / np.std(answers, axis=0)
    if memory:
        assert np.all(plain < 0.15)  # what the textbook would have said


def test_too_few_blocks_tell_nothing():
    covariance = sandwich_covariance(np.eye(2), np.ones((3, 2, 2)), np.ones((3, 2)), np.zeros(3, dtype=np.intp))
    assert np.all(np.isnan(covariance))


def test_centred_blocks_leave_out_what_trials_share():
    rng, trial = np.random.default_rng(0), np.repeat(np.arange(4), 50)
    scores = rng.normal(size=(200, 1))
    shifted = scores + rng.normal(0.0, 10.0, (4, 1))[trial]
    sums = np.sqrt([[200.0]]), np.ones((200, 1, 1))
    plain, centred = (sandwich_covariance(*sums, one, trial, centred=True) for one in (scores, shifted))
    assert centred == pytest.approx(plain)
    assert plain == pytest.approx(sandwich_covariance(*sums, scores, trial), rel=0.2)
