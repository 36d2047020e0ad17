"""Triples of numbers against numpy's vectors."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.triple import cross, turned, turned_back


@pytest.fixture
def drawn():
    rng = np.random.default_rng(0)
    return rng.normal(size=(3, 3)), tuple(rng.normal(size=3).tolist()), tuple(rng.normal(size=3).tolist())


def test_products_are_numpys(drawn):
    A, a, b = drawn
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), rtol=1e-15, atol=1e-15)
    np.testing.assert_allclose(turned(A, a), A @ a, rtol=1e-14)
    np.testing.assert_allclose(turned_back(A, a), A.T @ a, rtol=1e-14)


def test_what_is_turned_back_is_what_it_was(drawn):
    _, a, b = drawn
    R = Rotation.from_rotvec(b).as_matrix()
    np.testing.assert_allclose(turned_back(R, turned(R, a)), a, rtol=1e-14)


def test_a_cross_product_is_upright_on_both(drawn):
    _, a, b = drawn
    np.testing.assert_allclose([np.dot(cross(a, b), a), np.dot(cross(a, b), b)], 0.0, atol=1e-14)
    assert cross((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) == (0.0, 0.0, 1.0)
