"""The search of eq. (9) on sums."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.regressor import regressor
from arm.structural_parameters import structural_parameters
from fitter.dynamics.torque_search import assembled, fit_sums
from fitter.regression_sums.torque_sums import torque_sums
from limbcal.errors import ConfigError, NotConverged

ARM = load_arm("dd-arm")
BASE = structural_parameters(ARM)
TRUE = np.array([2.0, 1.7, 0.2, 0.5, 0.1, 0.05, 0.02, 0.01])


@pytest.fixture(scope="module")
def sums():
    rng = np.random.default_rng(0)
    q, dq, ddq = rng.normal(size=(3, 500, 2))
    tau = regressor(ARM, q, dq, ddq)[..., BASE.independent] @ TRUE + 0.1 * rng.normal(size=(500, 2))
    return torque_sums(ARM, BASE, q, dq, ddq, tau)


def test_the_genetic_search_ends_at_the_least_squares_answer(sums):
    found, least_squares = (fit_sums(ARM, BASE, sums, method=method) for method in ("ga", "least-squares"))
    values = [found.parameters[name].value for name in BASE.names]
    assert values == pytest.approx([least_squares.parameters[name].value for name in BASE.names], rel=1e-9)
    assert values == pytest.approx(TRUE, abs=0.05)


@pytest.mark.parametrize("method", ["ga", "least-squares"])
def test_within_bounds_the_answer_is_the_best_there(sums, method):
    """As if those that the bounds stop were known."""
    bounds = {"I2": (0.0, 0.4), "m2*sx2": (0.0, 1.7), "D1": (0.03, 0.03), "D2": (0.0, 1.0)}
    fit = fit_sums(ARM, BASE, sums, method=method, bounds=bounds)
    at_bounds = {"I2": 0.4, "m2*sx2": 1.7, "D1": 0.03}
    held = fit_sums(ARM, BASE, sums, method="least-squares", fixed=at_bounds)
    for name in BASE.names:
        one, other = fit.parameters[name], held.parameters[name]
        assert (one.value, one.std) == pytest.approx((other.value, other.std), rel=1e-9, nan_ok=True)
    assert sorted(note.text.partition(" ")[0] for note in fit.notes) == sorted(at_bounds)


def test_one_generation_is_not_enough(sums):
    with pytest.raises(NotConverged, match="after 1 generations"):
        fit_sums(ARM, BASE, sums, generations=1)


def test_other_values_are_those_of_the_parameters_and_of_the_arm(sums):
    fit = fit_sums(ARM, BASE, sums, method="least-squares", fixed={"I2": 0.5})
    moved = assembled(fit, np.arange(1.0, 8.0))
    free = [BASE.names[k] for k in fit.problem.free]
    assert "I2" not in free
    assert [moved.parameters[name].value for name in free] == list(np.arange(1.0, 8.0))
    assert set(moved.arm.base_parameters) == set(free)


def test_what_is_called_wrongly_is_said(sums):
    with pytest.raises(ConfigError, match="no base parameter is called I9"):
        fit_sums(ARM, BASE, sums, fixed={"I9": 1.0})
    for method in ("ga", "least-squares"):
        with pytest.raises(ConfigError, match="bounds of I2"):
            fit_sums(ARM, BASE, sums, method=method, bounds={"I2": (2.0, 1.0)})
