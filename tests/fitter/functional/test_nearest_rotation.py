"""The nearest rotation is that of the singular value decomposition, and no mirror."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fitter.functional.nearest_rotation import nearest_rotations

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS, st.floats(1e-9, 1e3))
def test_it_is_that_of_the_singular_value_decomposition(seed, size):
    D = size * np.random.default_rng(seed).normal(size=(5, 3, 3))
    U, s, Vt = np.linalg.svd(D)
    U[:, :, 2] *= np.sign(np.linalg.det(U @ Vt))[:, None]
    gap = (s[:, 1] + np.sign(np.linalg.det(D)) * s[:, 2]) / s[:, 0]  # how surely the nearest one is that
    R = nearest_rotations(D)
    assert np.all(np.abs(R - U @ Vt).max(axis=(1, 2)) < 1e-13 / gap)
    assert np.allclose(np.linalg.det(R), 1.0)


@given(SEEDS)
def test_of_flat_points_it_is_the_rotation_that_turned_them(seed):
    rng = np.random.default_rng(seed)
    R = Rotation.random(4, random_state=rng).as_matrix()
    flat = np.diag([0.01, 0.004, 0.0])
    assert np.allclose(nearest_rotations(R @ flat), R, atol=1e-12)


def test_of_nothing_it_is_some_rotation():
    (R,) = nearest_rotations(np.zeros((1, 3, 3)))
    assert np.allclose(R @ R.T, np.eye(3)) and np.isclose(np.linalg.det(R), 1.0)
