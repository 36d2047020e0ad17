"""Numbers of a diagnosis in words."""

import math

import pytest
from scipy.stats import norm

from arm.arm_file import load_arm
from fitter.report.diagnosis_words import angle, fell, measured, percent, rounded, trial_offsets
from fitter.search.fitted_parameter import FittedParameter


@pytest.mark.parametrize(
    ("value", "half", "expected"),
    [(1.23456, 0.012, "1.235"), (123.456, 20.0, "123"), (0.5, math.nan, "0.5"), (math.nan, 0.1, "–")],
)
def test_a_value_is_rounded_to_the_second_digit_of_its_uncertainty(value, half, expected):
    assert rounded(value, half) == expected


def test_half_of_the_interval_is_95_percent_of_a_normal_distribution():
    _, around = measured(FittedParameter(2.0, 0.1, "N m", True))
    assert float(around.removeprefix("± ")) == pytest.approx(norm.ppf(0.975) * 0.1, rel=0.05)
    assert measured(FittedParameter(math.pi / 6.0, 0.01, "rad", True))[0].endswith("(30°)")


def test_an_error_falls_grows_or_ran_away():
    assert fell(0.25) == "falls by 25 %" and fell(-0.5) == "grows by 50 %" and fell(-2.0).startswith("grows to 3 ")
    assert "ran away" in fell(math.nan) and angle(math.inf) == "ran away" and percent(math.nan) == "–"


def test_constant_torques_of_trials_are_named_where_there_are_any():
    arm = load_arm("dd-arm-vertical")
    assert trial_offsets((0.0, 0.0), arm) == ""
    assert "0.068 N m rms at joint 1:" in trial_offsets((0.0681, 0.0), arm)
    assert "0.068 N m rms at joint 1 and 0.05 N m rms at joint 2" in trial_offsets((0.0681, 0.05), arm)
