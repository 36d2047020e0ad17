"""The tip as a linear function of its basis."""

import numpy as np
import pytest

from arm.kinematics import tip_position
from arm.model import Arm, Joint
from fitter.kinematics.tip_basis import (
    basis,
    coefficients,
    geometry_names,
    geometry_of,
    jacobian,
    turning,
    with_geometry,
)


def random_arm(rng: np.random.Generator, n_joint: int) -> Arm:
    kinds = rng.choice(["revolute", "prismatic"], n_joint)
    return Arm("random", tuple(Joint(kind, *rng.normal(size=5)) for kind in kinds))


@pytest.mark.parametrize("n_joint", [1, 2, 3, 5])
def test_the_tip_is_linear_in_the_basis(n_joint):
    rng = np.random.default_rng(n_joint)
    for _ in range(5):
        arm, q = random_arm(rng, n_joint), rng.normal(size=(30, n_joint))
        phi = basis(turning(arm), q)
        assert np.all(phi[:, 0] == 1.0)
        tip = phi @ coefficients(turning(arm), geometry_of(arm)[None])[0].T
        assert np.allclose(tip, tip_position(arm, q), atol=1e-13)


def test_many_geometries_at_once():
    rng = np.random.default_rng(0)
    arm = random_arm(rng, 3)
    geometries = rng.normal(size=(7, 3, 5))
    together = coefficients(turning(arm), geometries)
    alone = [coefficients(turning(arm), geometry[None])[0] for geometry in geometries]
    assert np.allclose(together, alone, atol=1e-14)


def test_slopes():
    rng = np.random.default_rng(1)
    arm = random_arm(rng, 3)
    geometry, change = geometry_of(arm), 1e-6 * rng.normal(size=15)
    J = jacobian(turning(arm), geometry, np.arange(15))
    moved = coefficients(turning(arm), (geometry.ravel() + change).reshape(1, 3, 5))[0]
    assert np.allclose(
        moved - coefficients(turning(arm), geometry[None])[0], np.tensordot(change, J, axes=1), atol=1e-10
    )


def test_names_and_round_trip():
    arm = random_arm(np.random.default_rng(2), 2)
    assert geometry_names(2)[:6] == ("alpha1", "a1", "d1", "beta1", "theta_offset1", "alpha2")
    other = geometry_of(arm) + 1.0
    assert np.array_equal(geometry_of(with_geometry(arm, other)), other)
    assert with_geometry(arm, other).joints[1].beta_rad == other[1, 3]
