"""Gaps in time stamps, under jitter."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.data.gaps import Gap, find_gaps


def test_an_even_clock_has_no_gap():
    dt_s, gaps = find_gaps(7.0 + np.arange(1000) / 32000)
    assert gaps == ()
    assert np.isclose(dt_s, 1 / 32000, rtol=1e-9)


def test_a_single_late_stamp_is_no_gap():
    t = np.arange(100.0)
    t[50] += 0.9
    t[70:73] += 0.8
    assert find_gaps(t)[1] == ()


def test_gaps_next_to_each_other_and_at_the_ends():
    t = np.delete(np.arange(60.0), [1, 30, 31, 33, 58])
    assert find_gaps(t)[1] == (Gap(1, 1), Gap(29, 2), Gap(30, 1), Gap(54, 1))


@given(
    st.sets(st.integers(100, 900).map(lambda k: 20 * (k // 20)), max_size=8),
    st.integers(1, 200),
    st.floats(0.0, 0.2),
    st.integers(0, 2**32 - 1),
)
def test_gaps_are_found_and_counted_under_jitter(places, lost, jitter, seed):
    dt_s, index = 1 / 32000, np.arange(1000)
    for place in places:
        index[place:] += lost
    t = dt_s * (index + jitter * np.random.default_rng(seed).uniform(-1, 1, len(index)))
    found_dt_s, gaps = find_gaps(t)
    assert [gap.row for gap in gaps] == sorted(places)
    assert {gap.samples for gap in gaps} <= {lost}
    assert np.isclose(found_dt_s, dt_s, rtol=1e-3)


def test_a_late_stamp_right_before_a_gap_is_none_itself():
    t = np.arange(40.0)
    t[20] += 0.9
    t[22:] += 5.0
    assert find_gaps(t)[1] == (Gap(22, 5),)


def test_three_samples_between_gaps_tell_the_step():
    index = np.concatenate([100 * block + np.arange(3) for block in range(20)])
    dt_s, gaps = find_gaps(5.0 + 0.004 * index)
    assert dt_s == pytest.approx(0.004)
    assert gaps == tuple(Gap(3 * block, 97) for block in range(1, 20))


@pytest.mark.parametrize(("late", "gaps"), [(8, ()), (9, (Gap(50, 1),))])
def test_half_of_sixteen_stamps_that_are_late_are_no_gap(late, gaps):
    t = np.arange(100.0)
    t[50 : 50 + late] += 0.9
    assert find_gaps(t)[1] == gaps


def test_stamps_before_a_gap_are_seen_sixteen_back():
    """Eight of them came late, by steps that show nothing: half of them are as they should be."""
    t = np.arange(100.0)
    t[42:46] += 0.45
    t[46:50] += 0.9
    t[50:] += 0.6
    for more, samples in ((0.0, 0), (1.2, 1), (2.2, 2)):
        later = t + np.where(np.arange(100) >= 50, more, 0.0)
        assert sum(gap.samples for gap in find_gaps(later)[1]) == samples


@pytest.mark.parametrize(
    ("t", "dt_s", "gaps"),
    [
        ([0.0, 2.0], 2.0, ()),
        ([0.0, 1.0, 2.0, 3.0, 10.0], 1.0, (Gap(4, 6),)),
        ([0.0, 7.0, 8.0, 9.0, 10.0], 1.0, (Gap(1, 6),)),
        ([0.0, 0.5, 1.0, 2.0, 2.5, 3.0], 0.5, (Gap(3, 1),)),
        ([0.0, 1.0, 2.0, 3.4, 4.0, 5.0], 1.0, ()),
    ],
)
def test_a_handful_of_stamps(t, dt_s, gaps):
    assert find_gaps(np.array(t)) == (pytest.approx(dt_s), gaps)


def test_a_step_of_more_than_a_half_too_long_may_be_a_gap():
    """Half of the stamps after it are late by half a step and a little more."""
    t = np.arange(40.0)
    for late, found in ((0.499, ()), (0.501, (Gap(20, 1),))):
        assert find_gaps(t + np.where(t >= 20.0, late, 0.0))[1] == found


def test_stamps_of_800_hz_in_whole_milliseconds_have_no_gap():
    t = np.round(np.arange(4000) / 800.0, 3)
    dt_s, gaps = find_gaps(t)
    assert gaps == ()
    assert dt_s == pytest.approx(1 / 800, rel=1e-3)
    t[2000:] += 0.050
    assert find_gaps(t)[1] == (Gap(2000, 40),)
