"""Another unit is asked about only where the contract's is next to impossible."""

import math

import pytest

from protocol.tables.magnitude import (
    JOINT_RANGE,
    JOINT_SPEED,
    RATE_HZ,
    REACH_RATIO,
    SLIDE_SPEED,
    WHEEL,
    WHEEL_RANGE,
    Size,
    likely,
    probabilities,
)


def test_an_equal_chance_leaves_the_contract_s_unit():
    assert likely({"s": 0.0, "ms": 0.0}, "s") is None
    assert likely({"s": -5.0, "ms": 0.0}, "s") is None


def test_a_unit_that_is_far_likelier_is_named_even_beside_another_one():
    assert likely({"m": -15.0, "mm": -0.2, "cm": -0.9}, "m") == "mm"


@pytest.mark.parametrize(
    ("evidence", "named"), [(math.log(99 * 19) - 0.01, None), (math.log(99 * 19) + 0.01, "ms")]
)
def test_another_unit_is_named_from_19_to_1_on(evidence, named):
    """It begins at 1 to 99."""
    assert likely({"s": -evidence, "ms": 0.0}, "s") == named
    assert likely({"ms": 2.0, "s": 2.0 - evidence}, "s") == named


def test_without_evidence_probabilities_are_those_from_before():
    assert probabilities({"s": 3.0}, "s") == {"s": 1.0}
    assert probabilities({"ms": 3.0, "s": 3.0}, "s") == pytest.approx({"ms": 0.01, "s": 0.99})
    assert probabilities({"s": 0.0, "ms": 0.0, "us": 0.0}, "s") == pytest.approx(
        {"s": 0.99, "ms": 0.005, "us": 0.005}
    )


def test_evidence_multiplies_them():
    found = probabilities({"s": -800.0, "ms": -800.0 + math.log(33.0)}, "s")
    assert found == pytest.approx({"s": 0.75, "ms": 0.25})


@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, -math.inf, math.nan])
def test_no_size_says_nothing(value):
    assert Size(1.0, 0.5).log_likelihood(value) == 0.0


@pytest.mark.parametrize(("value", "expected"), [(10.0, -2.0), (1.0, 0.0), (0.1, -2.0), (100.0, -8.0)])
def test_a_size_far_from_the_usual_is_unlikely_by_its_decades(value, expected):
    assert Size(1.0, 0.5).log_likelihood(value) == pytest.approx(expected)
    assert Size(3.0, 1.0).log_likelihood(3.0 * value) == pytest.approx(expected / 4.0)


def test_the_smallest_number_there_is_is_a_size_too():
    assert Size(30.0, 0.75).log_likelihood(5e-324) == pytest.approx(
        -0.5 * ((323.306 + 1.477) / 0.75) ** 2, rel=1e-5
    )


@pytest.mark.parametrize(
    ("size", "median", "least", "most"),
    [
        (JOINT_SPEED, 2.0, 0.2, 20.0),
        (SLIDE_SPEED, 0.3, 0.03, 3.0),
        (JOINT_RANGE, 1.5, 0.25, 9.0),
        (WHEEL_RANGE, 30.0, 1.0, 1000.0),
        (RATE_HZ, 300.0, 10.0, 10_000.0),
        (REACH_RATIO, 1.0, 0.1, 10.0),
    ],
)
def test_of_usual_sizes_95_in_100_lie_between_their_bounds(size, median, least, most):
    """Two standard deviations are a log likelihood of −2."""
    assert [size.log_likelihood(bound) for bound in (least, most)] == pytest.approx([-2.0, -2.0], abs=0.12)
    assert size.log_likelihood(median) == 0.0


def test_one_joint_in_thirty_is_a_wheel():
    assert pytest.approx(1.0 / WHEEL) == 30.0
