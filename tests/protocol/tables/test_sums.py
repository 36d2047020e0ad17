"""Sums of columns as a mapping writes them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocol.tables.sums import ColumnSum, parse_sum, role_sums


@pytest.mark.parametrize(
    ("text", "terms", "constant"),
    [
        ("a", {"a": 1.0}, 0.0),
        ("-a + pi", {"a": -1.0}, math.pi),
        ("Y(join 1:20)[2] - Y(join 1:20)[1]", {"Y(join 1:20)[2]": 1.0, "Y(join 1:20)[1]": -1.0}, 0.0),
        ("kp/800", {"kp": 1 / 800}, 0.0),
        ("2*a/4-1e-3*pos meas - -1", {"a": 0.5, "pos meas": -1e-3}, 1.0),
        ("entries.position-pi/2", {"entries.position": 1.0}, -math.pi / 2),
        ("q1 [a-b]", {"q1 [a-b]": 1.0}, 0.0),
        ("0.001", {}, 0.001),
        ("2nd_joint*2", {"2nd_joint": 2.0}, 0.0),
    ],
)
def test_what_a_sum_says(text, terms, constant):
    found = parse_sum(text)
    assert dict(found.terms) == pytest.approx(terms) and found.constant == pytest.approx(constant)


@pytest.mark.parametrize("text", ["", "a*b", "1/a", "a-", "*a", "a/0", "(a)(b", "a--", "a 3*"])
def test_what_is_no_sum(text):
    assert parse_sum(text) is None


numbers = st.floats(0.001, 1000.0)


@given(st.lists(st.tuples(st.sampled_from(["x", "y_1", "z[2]", "w(3).v"]), numbers, st.booleans()), min_size=1))
def test_a_sum_adds_up_what_was_read(written):
    text = "".join(f"{'-' if minus else '+'}{factor!r}*{name}" for name, factor, minus in written) + "-7.5"
    found = parse_sum(text)
    read = np.arange(1.0, 1.0 + len(written)) * np.array([[1.0], [2.0]])
    expected = sum((-f if minus else f) * read[:, k] for k, (_, f, minus) in enumerate(written)) - 7.5
    assert np.allclose(role_sums([found]).of(read)[:, 0], expected)


def test_a_plain_column_is_no_more_than_that():
    assert ColumnSum((("a", 1.0),)).is_plain
    assert not parse_sum("-a").is_plain and not parse_sum("a+1").is_plain and not parse_sum("1").is_plain
