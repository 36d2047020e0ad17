"""Composite bodies against the points of mass that they are made of."""

import numpy as np

from arm.composite_bodies import tensor_about, turned_tensor

RNG = np.random.default_rng(0)
MASSES, PLACES = RNG.uniform(0.1, 2.0, 5), RNG.normal(size=(5, 3))


def tensor(places: np.ndarray) -> np.ndarray:
    """Return the inertia tensor of the points of mass about the origin: xx yy zz xy xz yz."""
    full = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(MASSES, places, strict=True))
    return full[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def test_a_tensor_turns_with_its_body():
    R = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    R *= np.linalg.det(R)
    np.testing.assert_allclose(turned_tensor(R, tuple(tensor(PLACES))), tensor(PLACES @ R.T), rtol=0, atol=1e-12)


def test_a_tensor_is_taken_about_another_origin():
    p, s = RNG.normal(size=3), MASSES @ PLACES
    moved = tensor_about(tuple(tensor(PLACES)), tuple(s), MASSES.sum(), tuple(p))
    np.testing.assert_allclose(moved, tensor(PLACES + p), rtol=0, atol=1e-12)
