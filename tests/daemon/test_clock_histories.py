"""Whatever a device's clock shows, stamps stay near the host's, and what is called exact is."""

import numpy as np
import pytest

from tests.daemon.clock_histories import FRAME, drawn, received
from tests.soak import Long

#: What the way of a frame may take beyond the shortest: a reader's batch and two waits of a busy host [s].
_WAY_S = 0.02
#: A lie is recognised within so long [s].
_RECOGNISED_S = 1.0


@pytest.mark.parametrize("part", range(4))
def test_stamps_stay_near_the_host_and_counts_are_right_where_they_are_called_exact(part: int, long: Long) -> None:
    beyond = known = 0
    n_history = long.of(2500, 40)
    for seed in range(part * n_history, (part + 1) * n_history):
        history = drawn(seed)
        found = received(history, seed)
        came = np.flatnonzero(history.sent)
        taken_s, first = history.taken_s[came], came * FRAME
        assert len(found.number) == len(came)
        assert np.all(np.diff(found.stamp_s) >= 0.0)
        if all(gap.exact for gap in found.gaps if "clock jumped" not in gap.why):
            np.testing.assert_array_equal(found.number, first)
        recent = [(taken_s > lie_s) & (taken_s <= lie_s + _RECOGNISED_S) for lie_s in history.lies_s]
        settled = ~np.any(recent, axis=0) if recent else np.ones(len(taken_s), dtype=np.bool_)
        stated = settled & np.isfinite(found.error_s)
        off = np.abs(found.stamp_s - taken_s)
        beyond += int(np.count_nonzero(off[stated] > 3.0 * found.error_s[stated] + _WAY_S))
        known += int(np.count_nonzero(stated))
    long.note(f"{n_history} histories: {beyond} of {known} stamps beyond three stated errors")
    assert beyond <= 3e-3 * known  # three standard errors hold 99.7 %


def test_a_timer_that_is_read_in_two_halves_moves_no_stamp_and_costs_no_sample() -> None:
    history = drawn(6)
    assert not history.lies_s and np.all(history.sent)
    history.ticks[120] += 1 << 32
    found = received(history, 0)
    (gap,) = found.gaps
    assert (gap.samples, gap.exact) == (0, False) and "clock jumped by +" in gap.why
    assert found.lost == 0
    np.testing.assert_array_equal(found.number, FRAME * np.arange(len(history.ticks)))
    assert np.max(np.abs(np.diff(found.stamp_s) - np.diff(history.taken_s))) < _WAY_S


def test_a_clock_that_jumps_an_hour_is_taken_back_by_an_hour() -> None:
    history = drawn(6)
    history.ticks[150:] = [tick + round(3600 * history.tick_hz) for tick in history.ticks[150:]]
    found = received(history, 0)
    assert found.lost == 0
    assert np.max(np.abs(found.stamp_s - history.taken_s)) < 2 * _WAY_S


def test_a_clock_that_stands_still_is_off_once_and_samples_are_counted_by_frames() -> None:
    history = drawn(6)
    history.ticks[100:200] = [history.ticks[100]] * 100
    found = received(history, 0)
    assert [gap.samples for gap in found.gaps] == [0]
    np.testing.assert_array_equal(found.number, FRAME * np.arange(len(history.ticks)))
    assert np.max(np.abs(found.stamp_s - history.taken_s)) < 2 * _WAY_S
