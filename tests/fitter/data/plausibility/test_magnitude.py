"""Another unit is asked about only where the contract's is next to impossible."""

from fitter.data.plausibility.magnitude import Size, likely


def test_an_equal_chance_leaves_the_contract_s_unit():
    assert likely({"s": 0.0, "ms": 0.0}, "s") is None
    assert likely({"s": -5.0, "ms": 0.0}, "s") is None


def test_a_unit_that_is_far_likelier_is_named_even_beside_another_one():
    assert likely({"m": -15.0, "mm": -0.2, "cm": -0.9}, "m") == "mm"


def test_no_size_says_nothing():
    assert Size(1.0, 0.5).log_likelihood(0.0) == 0.0 and Size(1.0, 0.5).log_likelihood(10.0) == -2.0
