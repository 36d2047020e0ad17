"""How kernels are compiled."""

import sys

import numpy as np

from limbcal.compiled import borrowed, compiled, cut


@compiled
def ratio(a: float, b: float) -> float:
    """Return a quotient."""
    return a / b


@compiled
def total(x: np.ndarray) -> float:
    """Return a sum, taken in order."""
    result = 0.0
    for value in x:
        result += value
    return result


def test_division_by_zero_follows_ieee_754():
    assert ratio(1.0, 0.0) == np.inf and ratio(-1.0, 0.0) == -np.inf and np.isnan(ratio(0.0, 0.0))


def test_additions_keep_their_order():
    """Sums must not depend on how wide the machine's registers are."""
    x = np.random.default_rng(0).normal(size=1001)
    assert total(x) == ratio(sum(x.tolist()), 1.0)


def test_nan_and_infinity_are_not_optimised_away():
    assert np.isnan(total(np.array([1.0, np.nan]))) and total(np.array([np.inf, 1.0])) == np.inf


@compiled
def doubled(x: np.ndarray) -> int:
    """Double what stands from the third number on, in two rows of three, and say where it ends."""
    rows, end = cut(x, 2, (2, 3))
    rows[:] = 2.0 * rows
    rows[1, 2] += 0.5
    return end


def test_a_cut_is_a_view_alike_in_python_and_in_kernels():
    of_kernel, of_python = np.arange(10.0), np.arange(10.0)
    assert doubled(of_kernel) == doubled.py_func(of_python) == 8
    np.testing.assert_array_equal(of_kernel, [0, 1, 4, 6, 8, 10, 12, 14.5, 8, 9])
    np.testing.assert_array_equal(of_python, of_kernel)


@compiled
def added_up(parts: tuple[np.ndarray, tuple[np.ndarray, float]]) -> float:
    """Add up what two arrays and a number hold, after the first has been changed."""
    a, (b, c) = borrowed(parts)
    a[0] += 1.0
    return a.sum() + b.sum() + c


def test_what_is_borrowed_is_the_same_memory():
    a, b = np.arange(3.0), np.ones((2, 2))
    references = sys.getrefcount(a), sys.getrefcount(b)
    assert [added_up((a, (b, 0.5))) for _ in range(3)] == [8.5, 9.5, 10.5]
    assert a.tolist() == [3.0, 1.0, 2.0]
    assert (sys.getrefcount(a), sys.getrefcount(b)) == references


@compiled
def shifted(x: float, by: int) -> float:
    """Return a number with another added."""
    return x + by


@compiled
def shifted_twice(x: float, by: int) -> float:
    """Shift by a number that stands here, and by one that does not."""
    return shifted(shifted(x, 3), by)


def test_a_number_in_a_callers_source_compiles_nothing_again():
    assert shifted_twice(1.0, 2) == 6.0
    assert shifted(1.0, 3) == 4.0  # what was compiled in an earlier run is looked up, not compiled for its caller
    assert len(shifted.signatures) == 1
