"""Noise of the angles, undone in expectation."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.kinematics.angle_products import basis_factor, products, undone, undone_gram
from fitter.kinematics.tip_basis import basis

NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(24)
KINDS = st.lists(st.booleans(), min_size=1, max_size=2)


def noisy(q, std):
    """Return angles with noise at the nodes of a Gauss-Hermite rule, and the rule's weights."""
    grids = np.meshgrid(*([NODES] * len(q)), indexing="ij")
    weight = np.ones(1)
    for _ in q:
        weight = np.kron(weight, WEIGHTS / WEIGHTS.sum())
    return q + std * np.column_stack([grid.ravel() for grid in grids]), weight


@settings(max_examples=30, deadline=None)
@given(KINDS, st.integers(0, 999))
def test_products_of_noisy_angles_become_those_of_true_ones(revolute, seed):
    rng = np.random.default_rng(seed)
    q, std = rng.normal(size=len(revolute)), rng.uniform(0.0, 0.3, len(revolute))
    measured, weight = noisy(q, std)
    mean = weight @ products(revolute, measured, 4)
    assert np.allclose(undone(revolute, mean[None], 4, std**2)[0], products(revolute, q[None], 4)[0], atol=1e-9)


@settings(max_examples=30, deadline=None)
@given(KINDS, st.integers(0, 999))
def test_so_do_the_basis_and_its_gram(revolute, seed):
    rng = np.random.default_rng(seed)
    q, std = rng.normal(size=len(revolute)), rng.uniform(0.0, 0.3, len(revolute))
    measured, weight = noisy(q, std)
    phi, true = basis(revolute, measured), basis(revolute, q[None])[0]
    gram = undone_gram(revolute, ((phi * weight[:, None]).T @ phi)[None], std**2)[0]
    assert np.allclose(gram, np.outer(true, true), atol=1e-9)
    assert np.allclose(basis_factor(revolute, std**2) * (weight @ phi), true, atol=1e-9)


def test_without_noise_nothing_changes():
    rng = np.random.default_rng(0)
    table, gram = products((True, False), rng.normal(size=(4, 2)), 3), rng.normal(size=(2, 6, 6))
    assert np.array_equal(undone((True, False), table, 3, np.zeros(2)), table)
    assert np.allclose(
        undone_gram((True, False), gram + gram.swapaxes(1, 2), np.zeros(2)), gram + gram.swapaxes(1, 2)
    )
