"""The prior of a motion, its band and the diagonal of an inverse against dense ones."""

import numpy as np
import pytest
from scipy.linalg import cholesky_banded

from fitter.limb.marker_observations import FREEDOM
from fitter.limb.motion_equations import BEFORE, fill_band, inverse_diagonal, roughness

N, N_FRAME = 3, 12


@pytest.fixture
def motion():
    rng = np.random.default_rng(3)
    A = rng.normal(size=(N_FRAME, N, N))
    return rng.normal(size=(N_FRAME, N)), rng.uniform(0.5, 2.0, N), A @ A.mT + np.eye(N)


def dense(q, jerk, A, share):
    D = np.diff(np.eye(len(q)), BEFORE, axis=0)
    weight = (FREEDOM + 1.0) / (FREEDOM + jerk * np.diff(q, BEFORE, axis=0) ** 2) * jerk
    found = np.einsum("rk,rl,ri,ij->kilj", D, D, weight, np.eye(N))
    for k, one in enumerate(A):
        found[k, :, k] += share * one
    return found


def test_the_roughness_is_that_of_a_t_distribution(motion):
    q, jerk, _ = motion
    pull = np.full(q.shape, np.nan)
    expected = (FREEDOM + 1.0) * np.log1p(jerk * np.diff(q, BEFORE, axis=0) ** 2 / FREEDOM).sum()
    assert roughness(q, jerk, 0, N_FRAME, pull) == pytest.approx(expected)
    slope, h = np.empty(q.shape), 1e-6
    for k in np.ndindex(*q.shape):
        up, down = q.copy(), q.copy()
        up[k] += h
        down[k] -= h
        ends = [roughness(x, jerk, 0, N_FRAME, np.empty(q.shape)) for x in (up, down)]
        slope[k] = (ends[0] - ends[1]) / (2.0 * h)
    np.testing.assert_allclose(2.0 * pull, slope, atol=1e-6)


@pytest.mark.parametrize(("first", "end"), [(0, 5), (4, 7), (2, N_FRAME)])
def test_some_frames_have_their_part_of_the_whole(motion, first, end):
    q, jerk, A = motion
    whole, part = np.full(q.shape, np.nan), np.full(q.shape, np.nan)
    roughness(q, jerk, 0, N_FRAME, whole)
    before = roughness(q, jerk, first, end, part)
    np.testing.assert_allclose(part[first:end], whole[first:end], atol=1e-12)
    assert np.isnan(part[:first]).all() and np.isnan(part[end:]).all()
    moved = q.copy()
    moved[first:end] += 0.3
    gains = roughness(moved, jerk, first, end, part) - before
    both = [roughness(x, jerk, 0, N_FRAME, part) for x in (q, moved)]
    assert gains == pytest.approx(both[1] - both[0])
    size = (end - first) * N
    band = np.full((size, BEFORE * N + 1), np.nan)
    fill_band(q, jerk, A, 0.5, first, end, band)
    expected = dense(q, jerk, A, 0.5)[first:end, :, first:end].reshape(size, size)
    for below in range(min(BEFORE * N + 1, size)):
        np.testing.assert_allclose(band[: size - below, below], np.diag(expected, -below), atol=1e-12)


def test_too_few_frames_are_not_rough(motion):
    q, jerk, _ = motion
    pull = np.full((BEFORE, N), np.nan)
    assert roughness(q[:BEFORE], jerk, 0, BEFORE, pull) == 0.0
    np.testing.assert_array_equal(pull, 0.0)


def test_the_inverses_diagonal_is_the_dense_ones(motion):
    q, jerk, A = motion
    band, found = np.empty((q.size, BEFORE * N + 1)), np.empty(q.size)
    fill_band(q, jerk, A, 1.0, 0, N_FRAME, band)
    inverse_diagonal(cholesky_banded(band.T, lower=True).T, found)
    expected = np.linalg.inv(dense(q, jerk, A, 1.0).reshape(q.size, q.size))
    np.testing.assert_allclose(found, np.diag(expected), rtol=1e-9)
