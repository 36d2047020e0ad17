"""A number is printed to the digits that its uncertainty leaves."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from limbcal.digits import plain, to_the_place_of, with_half_width

VALUES = st.floats(-1e9, 1e9)
HALF_WIDTHS = st.floats(1e-12, 1e9)


def significant(text):
    """Return how many significant digits a printed number has."""
    digits = text.partition("e")[0].replace(".", "").replace("-", "")
    return len(digits.lstrip("0"))


def last_place(text):
    """Return the decimal exponent of the last printed digit."""
    mantissa, _, exponent = text.partition("e")
    return int(exponent or 0) - len(mantissa.partition(".")[2])


@pytest.mark.parametrize(
    ("value", "half_width", "printed"),
    [
        (1.7186321, 0.00123, ("1.7186", "0.0012")),
        (1.98, 0.0996, ("1.98", "0.10")),
        (-0.0024, 0.019, ("-0.002", "0.019")),
        (-0.0004, 0.19, ("0.00", "0.19")),
        (30.2, 47.7, ("30", "48")),
        (12345.0, 1234.0, ("12300", "1200")),
        (3.21e-9, 1.1e-10, ("3.21e-09", "1.1e-10")),
        (0.25, 2.1e-13, ("0.25000000000000", "2.1e-13")),
        (1e-9, 1e-5, ("0.000000", "0.000010")),
        (1e-9, 1e-6, ("0", "1.0e-06")),
        (9.81, math.nan, ("9.810", "–")),
        (9.81, 0.0, ("9.810", "–")),
        (0.0, math.inf, ("0", "–")),
        (math.nan, 0.1, ("–", "–")),
    ],
)
def test_examples(value, half_width, printed):
    assert with_half_width(value, half_width) == printed


@given(VALUES, HALF_WIDTHS)
def test_the_half_width_has_two_digits_and_the_value_ends_where_it_does(value, half_width):
    said, around = with_half_width(value, half_width)
    place = math.floor(math.log10(float(around)) + 1e-9) - 1
    assert abs(float(around) - half_width) <= 0.5001 * 10.0**place * 1.0001
    assert abs(float(said) - value) <= 0.5001 * 10.0**place + 1e-15 * abs(value)
    assert abs(float(around) - half_width) <= 0.051 * half_width
    if half_width < 10.0:
        assert significant(around) == 2
        assert last_place(around) == place
        assert float(said) == 0.0 or last_place(said) == place


@given(VALUES, HALF_WIDTHS)
def test_the_printed_interval_does_not_leave_the_interval_by_more_than_rounding(value, half_width):
    said, around = map(float, with_half_width(value, half_width))
    assert abs((said - around) - (value - half_width)) <= 0.11 * half_width + 1e-12 * abs(value)
    assert abs((said + around) - (value + half_width)) <= 0.11 * half_width + 1e-12 * abs(value)


@given(VALUES, HALF_WIDTHS)
def test_a_sign_changes_nothing_else(value, half_width):
    said, around = with_half_width(value, half_width)
    turned, same = with_half_width(-value, half_width)
    assert float(turned) == -float(said) and same == around
    assert not said.startswith("-0") or float(said) != 0.0


@given(VALUES)
def test_a_value_alone_has_four_digits(value):
    assume(value == 0.0 or abs(value) > 1e-300)
    assert abs(float(plain(value)) - value) <= 0.00051 * abs(value)
    assert float(plain(value, 2)) == pytest.approx(value, rel=0.051)


def test_another_value_goes_to_the_same_place():
    assert to_the_place_of(1.718632, 0.00123) == "1.7186"
    assert to_the_place_of(1.718632, math.nan) == "1.719"
    assert to_the_place_of(0.0, 6.1e-11) == "0"
