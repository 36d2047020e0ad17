"""What an experiment hands back."""

import pytest

from reproduction.experiment import Grid


def test_a_row_that_is_not_as_wide_as_the_header_is_refused():
    assert Grid("t", ("a", "b"), ((1.0, None), ("x", 2.0))).rows[0] == (1.0, None)
    with pytest.raises(ValueError, match=r"\[1, 3\] cells, expected 2"):
        Grid("t", ("a", "b"), ((1.0,), (1.0, 2.0), (1.0, 2.0, 3.0)))
