"""The end of a mode is found exactly and soon, whatever way the slack goes there."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arm.mode_end import CUT_AT, narrow, next_try

WHOLE = 0.8


def found(slack, first, limit=200):
    """Return where a bracket closed, and in how many tries."""
    bracket = np.zeros((2, 1 + len(first)))
    bracket[0, 1:], bracket[1, 0] = first, WHOLE
    share, side = WHOLE, -1
    for tries in range(1, limit):
        values = np.atleast_1d(slack(share))
        side = narrow(bracket, side, share, values, bool(np.any(values < 0.0)))
        if bracket[1, 0] - bracket[0, 0] <= CUT_AT:
            return bracket, tries
        share = next_try(bracket, tries, side)
    raise AssertionError("it does not close")


@given(root=st.floats(1e-6, 0.79), power=st.sampled_from([0.3, 0.5, 1.0, 2.0, 3.0]), size=st.floats(1e-9, 1e9))
def test_it_closes_on_the_root(root, power, size):
    def slack(share):
        off = root - share
        return size * np.sign(off) * np.abs(off) ** power

    bracket, tries = found(slack, [slack(0.0)])
    assert bracket[0, 0] <= root + CUT_AT and bracket[1, 0] >= root - CUT_AT
    assert tries <= 4 * 44  # every fourth is a bisection


@pytest.mark.parametrize("curve", [-0.3, 0.0, 0.3])
def test_a_smooth_slack_takes_a_few_tries(curve):
    root = 0.37

    def slack(share):
        return (root - share) * (1.0 + curve * share)

    bracket, tries = found(slack, [slack(0.0)])
    assert abs(bracket[1, 0] - root) <= 2.0 * CUT_AT
    assert tries <= 15  # bisection takes 44


def test_of_several_the_first_counts():
    def slack(share):
        return np.array([0.6 - share, 0.2 - share, 0.5 + share])

    bracket, _ = found(slack, slack(0.0))
    assert bracket[1, 0] == pytest.approx(0.2, abs=1e-12)


def test_one_that_is_on_its_way_at_once_is_found_too():
    """A joint that was just let go has no speed yet."""
    bracket, _ = found(lambda share: np.array([share * (0.1 - share)]), [0.0])
    assert bracket[1, 0] == pytest.approx(0.1, abs=1e-12)


def test_a_joint_that_has_no_way_to_go_ends_its_mode_at_once():
    """Masses that none can have push a joint against its pull, whichever way it was let go."""
    bracket, tries = found(lambda share: np.array([-share, 0.5 - share]), [0.0, 0.5])
    assert bracket[0, 0] == 0.0 and bracket[1, 0] <= CUT_AT
    assert tries <= 3
