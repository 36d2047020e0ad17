"""The shooting problem without its initial states."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from fitter.dynamics.shooting_problem import simulated
from fitter.dynamics.variable_projection import linearised, moved
from tests.fitter.dynamics.single_slide import DT_S, FORCE, MASS, N, problem, window


def test_slopes_are_those_of_the_closed_form_off_the_initial_state_s():
    with ThreadPoolExecutor(1) as pool:
        one = problem([window()], pool)
        linear = linearised(
            one, simulated(one, np.array([MASS]), [window().start]), np.array([1e-6]), [np.ones(1)]
        )
    t = DT_S * np.arange(N)
    slope = -0.5 * FORCE / MASS**2 * t**2
    straight = np.column_stack([np.ones(N), t])
    expected = slope - straight @ np.linalg.lstsq(straight, slope, rcond=None)[0]
    assert linear.J[0][:, 0] == pytest.approx(expected, abs=1e-6)


def test_a_wrong_initial_state_leaves_no_residual_and_is_moved_to_the_right_one():
    true, wrong = np.array([0.1, -0.2]), np.array([0.4, 0.3])
    with ThreadPoolExecutor(1) as pool:
        one = problem([window(start=tuple(true))], pool)
        here = simulated(one, np.array([MASS]), [wrong])
        linear = linearised(one, here, np.array([1e-6]), [np.ones(1)])
        assert linear.r[0] == pytest.approx(0.0, abs=1e-9)
        there = moved(one, here, linear, np.zeros(1), [np.ones(1)])
    assert there.starts[0] == pytest.approx(true, abs=1e-8)
    assert there.residuals[0] == pytest.approx(0.0, abs=1e-9)
