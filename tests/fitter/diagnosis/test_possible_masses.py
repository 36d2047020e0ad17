"""Masses that no body has: a body is found on the way to one, whatever they are, and no further than needed."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.mass_density import MassDensity
from fitter.diagnosis.model import Model
from fitter.diagnosis.possible_masses import possible_base
from fitter.diagnosis.refinement import fitted
from tests.fitter.diagnosis.two_joints import regression_of_two


@pytest.fixture(scope="module")
def regression():
    return regression_of_two()


def density_of(regression, start):
    count = {motion.number: np.ones(2) for motion in regression.motions}
    return MassDensity(regression.equations, regression.motions, 0.5, count, start)


def test_possible_masses_stay_nearly_as_they_are(regression):
    base = fitted(regression, Model())
    density = density_of(regression, base.x)
    assert density.is_possible(base.x)
    np.testing.assert_allclose(possible_base(regression, base, density.is_possible, 1e-6), base.x, rtol=1e-3)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None, derandomize=True)
def test_from_any_masses_possible_ones_are_found(regression, seed):
    """Also from those of a torque the wrong way round, of which no least squares among possible arms was found."""
    base = fitted(regression, Model())
    rng = np.random.default_rng(seed)
    wrong = replace(base, x=base.x * rng.choice([-1.0, 1.0], len(base.x)) * rng.lognormal(0.0, 2.0, len(base.x)))
    density = density_of(regression, base.x)
    found = possible_base(regression, wrong, density.is_possible)
    assert density.is_possible(found)
    halved = wrong.x + 0.5 * (found - wrong.x)
    assert density.is_possible(wrong.x) or not density.is_possible(halved)
