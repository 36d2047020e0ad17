"""How far readings may be off at rest, by hand: without noise, where only a trusted resolution of 3e-5 limits."""

import numpy as np
import pytest

from tracking.dead_reckoning.rest import RestDetector
from tracking.dead_reckoning.rest_cell import WINDOW

UNIT = 3e-5
NO_CONTRAST = np.zeros((0, 2))


def rested(judge: RestDetector, value: float, n_cell: int, pinned: bool = True) -> list[bool]:
    """Return what is said of some cells in which both channels read a value."""
    return [judge.judge(np.full((8, 2), value), np.zeros(2), pinned) for _ in range(n_cell)]


@pytest.fixture
def judge() -> RestDetector:
    one = RestDetector(NO_CONTRAST, np.zeros(2))
    assert all(rested(one, 0.0, 100))
    return one


@pytest.mark.parametrize(("steps", "rests"), [(6.9, True), (-6.9, True), (7.1, False), (-7.1, False)])
def test_a_cell_may_be_off_by_seven_steps(judge, steps, rests) -> None:
    """While its window is not full: that of an arm at rest before."""
    judge.forget()
    assert rested(judge, steps * UNIT, 1) == [rests]


@pytest.mark.parametrize(("steps", "rests"), [(0.49, True), (0.51, False)])
def test_a_rest_begins_where_a_window_is_off_by_half_a_step(judge, steps, rests) -> None:
    assert rested(judge, 1.0, 3) == [False] * 3
    said = rested(judge, steps * UNIT, WINDOW + 5)
    assert said == [False] * (WINDOW - 1) + [rests] * 6


@pytest.mark.parametrize(("steps", "rests"), [(1.95, True), (2.05, False)])
def test_a_rest_ends_where_a_window_has_a_trend_of_two_steps(judge, steps, rests) -> None:
    """Four times what it may begin with; a later half that is off by one has a trend of 78 / 75."""
    said = rested(judge, steps * 75.0 / 78.0 * UNIT, WINDOW)
    assert all(said) == rests


def test_what_is_read_too_much_is_a_mean_that_forgets() -> None:
    """Of all cells of rest, and of 400 at the most."""
    for before, weight in ((0, 1), (30, 31), (399, 400), (800, 400)):
        judge = RestDetector(NO_CONTRAST, np.zeros(2))
        rested(judge, 0.0, before, pinned=False)
        rested(judge, 1e-5, 1, pinned=False)
        np.testing.assert_allclose(judge.offset, 1e-5 / weight, rtol=1e-12)
