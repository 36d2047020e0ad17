"""Upright frames, and how pelvis and thorax stand in their markers then."""

import numpy as np
import pytest

from fitter.body.stance import stance
from tests.fitter.body.simulated_body import RATE_HZ, WORLD


def test_the_first_second_is_upright_and_faces_as_the_person_does(fit):
    found = stance(fit.trials)
    assert found.rows[: int(RATE_HZ)].all() and not found.rows[int(1.5 * RATE_HZ) : int(2.5 * RATE_HZ)].any()
    away = np.degrees(np.arccos(np.clip(0.5 * (np.trace(found.world.T @ WORLD) - 1.0), -1.0, 1.0)))
    assert away < 3.0


@pytest.mark.parametrize("segment", ["pelvis", "thorax"])
def test_axes_in_a_segment_are_the_worlds_while_it_stands(fit, segment):
    found = stance(fit.trials)
    R = fit.trials.motions[segment].whole.R[5]
    np.testing.assert_allclose(R @ found.axes[segment], WORLD, atol=0.06)
