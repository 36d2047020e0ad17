"""Parameters as cells."""

import numpy as np

from fitter.report.published import PARAMETERS, TRUE
from fitter.search.fitted_parameter import FittedParameter
from reproduction.parameter_rows import (
    fitted_row,
    interval,
    off_percent,
    outside,
    worst_inertial_percent,
)

TRUTH = dict(zip(PARAMETERS, TRUE, strict=True))


def fitted(factor: float, std: float) -> dict[str, FittedParameter]:
    return {name: FittedParameter(factor * value, std * abs(value), "u", True) for name, value in TRUTH.items()}


def test_a_value_stands_with_half_its_95_percent_interval():
    assert interval(FittedParameter(1.5, 0.1, "u", True)) == "1.500000 ± 0.2"
    assert interval(FittedParameter(1.5, np.nan, "u", True)) == "1.500000"
    assert interval(FittedParameter(1.5, 0.1, "u", False)) == "not identified"


def test_a_combination_that_an_askew_arm_does_not_have_stays_empty():
    some = {name: p for name, p in fitted(1.0, 0.1).items() if name != "I2"}
    row = fitted_row(("x",), some)
    assert row[1 + PARAMETERS.index("I2")] is None
    assert len(row) == 1 + len(PARAMETERS)


def test_errors_are_in_percent_of_the_truth_and_held_against_the_interval():
    off = off_percent(fitted(1.02, 0.011), TRUTH)
    np.testing.assert_allclose([off[name] for name in PARAMETERS[:4]], 2.0)
    np.testing.assert_allclose(abs(off["D1"]), 2.0)
    np.testing.assert_allclose(worst_inertial_percent(fitted(0.97, 0.01), TRUTH), 3.0)
    assert outside(fitted(1.02, 0.011), TRUTH) == []
    assert outside(fitted(1.02, 0.010), TRUTH) == list(PARAMETERS)
    assert outside(fitted(1.02, np.nan), TRUTH) == list(PARAMETERS)
