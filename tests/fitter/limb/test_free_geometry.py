"""Steps of the free geometry and back, and what they make of an arm's joints."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.limbs import MEAN_PERSON, limb
from fitter.limb.free_geometry import free_geometry, geometry_of


@pytest.mark.parametrize(("preset", "lengths"), [("human-arm-right", 3), ("human-leg-right", 2)])
def test_a_step_is_the_difference_of_the_geometries(preset, lengths):
    arm = limb(replace(MEAN_PERSON, preset=preset))
    free, here = free_geometry(arm, 0.02, [0.03] * lengths), geometry_of(arm)
    assert len(free.names) == len(free.std) == len(set(free.names))
    assert len(free.units) == len(free.std)
    step = 0.01 * np.random.default_rng(0).normal(size=len(free.std))
    np.testing.assert_allclose(here.moved(free, step).away(free, here), step, atol=1e-12)
    np.testing.assert_allclose(here.away(free, here), 0.0, atol=1e-12)
    assert here.joints(arm) == arm.joints
