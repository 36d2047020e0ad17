"""Ten free numbers a body: always a possible one, the nominal at zero, slopes as differences have them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from arm.physical_links import is_possible
from benchmarks.simulated_people.ground import BASE
from fitter.ground.deformation import MASS, SHIFT, Deformation, radii

DEFORMATION = Deformation(BASE.links)


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 2.0))
def test_every_deformation_is_a_body_that_can_exist(seed, size):
    x = np.random.default_rng(seed).normal(0.0, size, DEFORMATION.size)
    assert all(is_possible(link) for link in DEFORMATION.parameters(x).reshape(-1, 10))


def test_zero_is_the_nominal_body_and_units_are_what_they_are_called():
    x = np.zeros(DEFORMATION.size).reshape(-1, 10)
    np.testing.assert_allclose(DEFORMATION.parameters(x.ravel()), BASE.links.ravel(), atol=1e-12)
    x[:, MASS] = np.log(1.1)
    np.testing.assert_allclose(DEFORMATION.parameters(x.ravel()), 1.1 * BASE.links.ravel(), atol=1e-12)
    x[:, MASS], x[:, SHIFT] = 0.0, (0.0, 1.0, 0.0)
    moved = DEFORMATION.parameters(x.ravel()).reshape(-1, 10)
    shift = moved[:, 6:9] / moved[:, 9:] - BASE.links[:, 6:9] / BASE.links[:, 9:]
    np.testing.assert_allclose(shift, radii(BASE.links)[:, :, 1], atol=1e-12)


def test_slopes_are_those_of_central_differences():
    x = np.random.default_rng(1).normal(0.0, 0.3, DEFORMATION.size)
    step = 1e-6
    for k in range(0, DEFORMATION.size, 7):
        e = step * np.eye(DEFORMATION.size)[k]
        slope = (DEFORMATION.parameters(x + e) - DEFORMATION.parameters(x - e)) / (2.0 * step)
        np.testing.assert_allclose(DEFORMATION.slopes(x)[:, k], slope, atol=1e-7)
