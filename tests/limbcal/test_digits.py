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


@pytest.mark.parametrize(
    ("value", "digits", "printed"),
    [
        (1.23456, 4, "1.235"),
        (-1.23456, 4, "-1.235"),
        (12.3456, 4, "12.35"),
        (1234.56, 4, "1235"),
        (12345.6, 4, "12350"),
        (123456.0, 4, "123500"),
        (999949.0, 4, "999900"),
        (999951.0, 4, "1.000e+06"),  # what it is once rounded
        (1234567.0, 4, "1.235e+06"),
        (1.23456e-5, 4, "0.00001235"),
        (9.9996e-6, 4, "0.00001000"),
        (9.99e-6, 4, "9.990e-06"),
        (0.25, 1, "0.2"),
        (0.35, 1, "0.3"),
        (7.6, 1, "8"),
        (1.5e7, 1, "2e+07"),
        (1.25e-7, 2, "1.2e-07"),
        (0.0, 4, "0"),
        (math.inf, 4, "–"),
        (-math.inf, 4, "–"),
        (math.nan, 4, "–"),
    ],
)
def test_a_value_alone_is_printed_to_its_digits(value, digits, printed):
    assert plain(value, digits) == printed
    if digits == 4:
        assert plain(value) == printed


@pytest.mark.parametrize(
    ("value", "half_width", "printed"),
    [
        (1234567.0, 1234.0, ("1.2346e+06", "1200")),
        (1234567.0, 12340.0, ("1.235e+06", "12000")),
        (1234567.0, 123400.0, ("1.23e+06", "120000")),
        (1234567.0, 1234000.0, ("1.2e+06", "1.2e+06")),
        (999960.0, 120.0, ("999960", "120")),
        (999996.0, 120.0, ("1.00000e+06", "120")),
        (2.34, 0.96, ("2.34", "0.96")),
        (2.34, 0.996, ("2.3", "1.0")),
        (2.34, 1.2, ("2.3", "1.2")),
        (2.34, 12.0, ("2", "12")),
        (0.04, 1.2, ("0.0", "1.2")),
        (0.4, 12.0, ("0", "12")),
        (6.0, 120.0, ("10", "120")),
        (4.0, 120.0, ("0", "120")),
        (4.0, 1234.0, ("0", "1200")),
        (1.5e6, 2.0e7, ("2e+06", "2.0e+07")),
        (0.000012, 0.0000021, ("0.0000120", "2.1e-06")),
        (0.0000089, 0.0000021, ("8.9e-06", "2.1e-06")),
        (1e-8, 1.2e-5, ("0.000000", "0.000012")),
        (1e-9, 1.2e-6, ("0", "1.2e-06")),
        (-0.00001, 0.12, ("0.00", "0.12")),
    ],
)
def test_a_value_ends_where_its_half_width_does(value, half_width, printed):
    assert with_half_width(value, half_width) == printed
    assert to_the_place_of(value, half_width) == printed[0]


def test_half_widths_that_are_none_leave_four_digits():
    for none in (0.0, -1.0, math.inf, math.nan):
        assert with_half_width(9.81, none) == ("9.810", "–")
    assert with_half_width(9.81, 1e-300)[1] == "1.0e-300"
    assert with_half_width(math.inf, 0.1) == ("–", "–")
