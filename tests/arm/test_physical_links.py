"""Which ten numbers can be a link's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.base_parameters import base_parameters
from arm.physical_links import _parameters, _slopes, is_possible, links_with, pseudo_inertia
from arm.regressor import standard_parameters

FEW = settings(max_examples=30, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


@FEW
@given(SEEDS)
def test_the_pseudo_inertia_is_the_second_moment_of_the_mass(seed):
    rng = np.random.default_rng(seed)
    mass, place = rng.uniform(0.1, 1.0, 6), rng.normal(size=(6, 3))
    at = np.hstack([place, np.ones((6, 1))])
    xx, yy, zz = (mass @ (place[:, a] ** 2 + place[:, b] ** 2) for a, b in ((1, 2), (0, 2), (0, 1)))
    xy, xz, yz = (-(mass * place[:, a]) @ place[:, b] for a, b in ((0, 1), (0, 2), (1, 2)))
    parameters = np.array([xx, yy, zz, xy, xz, yz, *(mass @ place), mass.sum()])
    np.testing.assert_allclose(pseudo_inertia(parameters), (mass[:, None] * at).T @ at, rtol=0, atol=1e-12)
    assert is_possible(parameters)


@pytest.mark.parametrize(
    ("what", "column", "value"),
    [("mass", 9, -1.0), ("inertia", 2, -0.1), ("triangle", 2, 9.0), ("offset", 6, 5.0)],
)
def test_what_no_mass_can_do_is_told(dd_arm, what, column, value):
    """A negative mass or inertia, one axis heavier than both others, a centre of mass outside the inertia."""
    parameters = standard_parameters(dd_arm)[10:20].copy()
    assert is_possible(parameters)
    parameters[column] = value
    assert not is_possible(parameters), what


def test_links_come_as_near_as_they_can_to_those_asked_for(dd_arm):
    """Where the arm has the combinations already, it stays as it is."""
    base = base_parameters(dd_arm)
    inertial = np.asarray(base.independent) < 20
    combination = base.combination[inertial][:, :20]
    found = links_with(dd_arm, combination, combination @ standard_parameters(dd_arm)[:20])
    for link, joint in zip(found, dd_arm.joints, strict=True):
        np.testing.assert_allclose(link.mass_kg, joint.link.mass_kg, rtol=1e-3)
        np.testing.assert_allclose(link.com_m, joint.link.com_m, rtol=0, atol=1e-3)


@FEW
@given(SEEDS)
def test_slopes_are_those_of_differences(seed):
    x = np.random.default_rng(seed).normal(size=30)
    step = 1e-5 * np.eye(30)
    differences = np.stack([_parameters(x + one) - _parameters(x - one) for one in step], axis=1) / 2e-5
    np.testing.assert_allclose(_slopes(x), differences, rtol=1e-6, atol=1e-6 * np.abs(differences).max())
