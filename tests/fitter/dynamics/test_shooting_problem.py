"""Residuals of shooting and their noise."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from fitter.dynamics.prior_and_limits import Allowed
from fitter.dynamics.shooting_problem import noise_std, pooled_rms, simulated, start_error, window_cost
from tests.fitter.dynamics.single_slide import MASS, N, problem, window


def test_residuals_are_the_measured_less_the_simulated_positions():
    start = np.array([0.1, -0.2])
    with ThreadPoolExecutor(1) as pool:
        point = simulated(problem([window()], pool), np.array([MASS]), [start + [0.5, 0.0]])
    assert point.residuals[0] == pytest.approx(-0.5 * np.ones((N, 1)))


def test_a_window_s_noise_is_all_of_them_s_its_own_or_between():
    residuals = [np.full((100, 1), 1.0), np.full((100, 1), 3.0)]
    pooled = pooled_rms(residuals)
    assert pooled == pytest.approx([np.sqrt(5.0)])
    assert noise_std(residuals, pooled, 0.0) == [pooled, pooled]
    own = np.ravel(noise_std(residuals, pooled, 1.0))
    assert own == pytest.approx(
        np.sqrt([(100 + 10) / 102, (900 + 10) / 102])
    )  # two samples of the pooled variance
    assert np.ravel(noise_std(residuals, pooled, 0.5)) == pytest.approx(np.sqrt(own * pooled))


def test_a_cost_is_chi_square_of_samples_initial_state_and_prior():
    seen = window(start_std=np.array([0.1, 0.2]))
    assert start_error(seen, seen.start - [0.1, -0.4]) == pytest.approx([1.0, -2.0])
    assert window_cost(seen, seen.start - [0.1, -0.4], np.full((N, 1), 3.0), np.ones(1)) == pytest.approx(
        9.0 * N + 5.0
    )
    with ThreadPoolExecutor(1) as pool:
        known = problem([seen], pool, allowed=Allowed(prior_std=0.5))
        here = simulated(known, np.array([MASS + 1.0]), [seen.start])
        rms = pooled_rms(here.residuals)
        assert here.cost(known, rms) == pytest.approx(N + 4.0, rel=1e-2)
