"""Simulations of a window."""

import numpy as np
import pytest

from fitter.dynamics.shooting import Shooting, finest_needed
from tests.fitter.dynamics.single_slide import BASE, DT_S, MASS, PLACE, SLIDE, positions, window

VALUES = np.zeros(len(BASE.names))
VALUES[PLACE] = 0.5 * MASS


def test_a_slide_under_a_constant_force_is_accelerated_uniformly():
    shooting = Shooting(SLIDE, BASE)
    start = np.array([0.3, -1.0])
    angles = shooting.angles(shooting.machine(VALUES), window(), start)
    assert angles == pytest.approx(positions(0.5 * MASS, start), abs=1e-12)


@pytest.mark.parametrize("steps", [1, 4])
def test_a_step_that_is_exact_is_not_halved(steps):
    """Runge and Kutta's steps are exact where the acceleration is constant."""

    def cut(step_s):
        return [window(dt_s=step_s)]

    assert finest_needed(Shooting(SLIDE, BASE), cut, VALUES, steps * DT_S) == steps * DT_S
