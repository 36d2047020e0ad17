"""Whatever a device's clock shows, stamps stay near the host's, and what is called exact is."""

import numpy as np
import pytest

from arm.model import Floats
from tests.daemon.clock_histories import FRAME, RATE_HZ, History, Outcome, drawn, held_back, received
from tests.soak import Long

#: What the way of a frame may take beyond the shortest: a reader's batch and two waits of a busy host [s].
_WAY_S = 0.02
#: A lie is recognised within so long [s].
_RECOGNISED_S = 1.0


@pytest.mark.parametrize("part", range(4))
def test_stamps_stay_near_the_host_and_exact_counts_are_right(part: int, long: Long) -> None:
    beyond = known = 0
    n_history = long.of(2500, 40)
    for seed in range(part * n_history, (part + 1) * n_history):
        history = drawn(seed)
        found = received(history, seed)
        came = np.flatnonzero(history.sent)
        taken_s, first = history.taken_s[came], came * FRAME
        assert len(found.number) == len(came)
        assert np.all(np.diff(found.stamp_s) >= 0.0)
        off = found.number - first
        inexact = {gap.sample0 for gap in found.gaps if not gap.exact}
        assert off[0] == 0
        assert inexact.issuperset(found.number[np.flatnonzero(np.diff(off))] + FRAME)
        recent = [(taken_s >= lie_s) & (taken_s <= lie_s + _RECOGNISED_S) for lie_s in history.lies_s]
        settled = ~np.any(recent, axis=0) if recent else np.ones(len(taken_s), dtype=np.bool_)
        stated = settled & np.isfinite(found.error_s)
        off_s = np.abs(found.stamp_s - taken_s)
        beyond += int(np.count_nonzero(off_s[stated] > 3.0 * found.error_s[stated] + _WAY_S))
        known += int(np.count_nonzero(stated))
    long.note(f"{n_history} histories: {beyond} of {known} stamps beyond three stated errors")
    assert beyond == 0


def test_a_late_delivery_moves_no_stamp_by_more_than_is_stated(long: Long) -> None:
    n_history, beyond, known, farthest_s = long.of(1000, 6), 0, 0, 0.0
    for seed in range(n_history):
        history, rng = drawn(6, 25.0), np.random.default_rng(seed)
        drift_s = rng.uniform(6.0, 15.0)
        if rng.random() < 0.5:  # one in two has an oscillator that drifts as well
            drifts = history.taken_s >= drift_s
            history.taken_s[drifts] += rng.uniform(-0.05, 0.05) * (history.taken_s[drifts] - drift_s)
        over_s = held_back(history, rng)
        off_s, found = _off_s(history, seed, over_s)
        heard_s = over_s[np.searchsorted(history.taken_s, drift_s)]  # nobody knows before of a drift
        settled = (history.taken_s < drift_s) | (over_s > heard_s + _RECOGNISED_S)
        stated = settled & np.isfinite(found.error_s)
        beyond += int(np.count_nonzero(off_s[stated] > 3.0 * found.error_s[stated] + _WAY_S))
        known += int(np.count_nonzero(stated))
        farthest_s = max(farthest_s, float(off_s[settled].max()))
        assert not found.gaps
    long.note(
        f"{n_history} late deliveries: {beyond} of {known} stamps beyond three stated errors, the farthest "
        f"{farthest_s:.2f} s off"
    )
    assert beyond == 0


@pytest.mark.parametrize("faster", [1.5, 4.0])
def test_a_delivery_that_catches_up_is_no_clock_that_halted(faster: float) -> None:
    history = drawn(6, 20.0)
    late_s = np.maximum(2.0 - (1.0 - 1.0 / faster) * np.maximum(history.taken_s - 8.0, 0.0), 0.0)
    over_s = history.taken_s + FRAME / RATE_HZ + np.where(history.taken_s >= 8.0, late_s, 0.0)
    off_s, found = _off_s(history, 0, over_s)
    assert off_s.max() < 0.35 and not found.gaps  # all that is late by a constant moves stamps: by two seconds


def test_a_timer_read_in_two_halves_costs_no_sample() -> None:
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


def test_while_a_clock_stands_still_frames_count_the_samples() -> None:
    history = drawn(6)
    history.ticks[100:200] = [history.ticks[100]] * 100
    found = received(history, 0)
    assert [gap.samples for gap in found.gaps] == [0]
    np.testing.assert_array_equal(found.number, FRAME * np.arange(len(history.ticks)))
    assert np.max(np.abs(found.stamp_s - history.taken_s)) < 2 * _WAY_S


def _off_s(history: History, seed: int = 0, handed_over_s: Floats | None = None) -> tuple[Floats, Outcome]:
    """Return by how much stamps are off, and all that was found."""
    found = received(history, seed, handed_over_s)
    assert found.lost == 0
    return np.abs(found.stamp_s - history.taken_s), found


@pytest.mark.parametrize("rate", [0.93, 0.97, 1.03, 1.07])
def test_arrivals_tell_when_while_a_clock_stands_still_and_the_rate_changes(rate: float) -> None:
    history = drawn(6, 12.0)
    history.ticks[300:] = [history.ticks[300]] * len(history.ticks[300:])
    history.taken_s[600:] = history.taken_s[600] + rate * (history.taken_s[600:] - history.taken_s[600])
    off_s, found = _off_s(history)
    assert np.nanmax(off_s - 3.0 * found.error_s) < _WAY_S
    assert off_s[-100:].max() < 0.1  # not followed, they would be off by 0.18 and 0.42 s


def test_a_clock_that_shows_anything_is_no_reason_to_lose_the_time() -> None:
    history = drawn(6, 12.0)
    shown = np.random.default_rng(1).integers(0, 1 << 40, 900)
    history.ticks[300:] = [int(tick) for tick in shown]
    history.taken_s[600:] = history.taken_s[600] + 1.05 * (history.taken_s[600:] - history.taken_s[600])
    off_s, found = _off_s(history)
    assert np.nanmax(off_s - 3.0 * found.error_s) < _WAY_S


def test_a_stated_error_stays_stated_on_a_new_line() -> None:
    history = drawn(6, 12.0)
    history.taken_s[400:] = history.taken_s[400] + 0.92 * (history.taken_s[400:] - history.taken_s[400])
    history.taken_s[800:] = history.taken_s[800] + 1.15 * (history.taken_s[800:] - history.taken_s[800])
    off_s, found = _off_s(history)
    first = int(np.flatnonzero(np.isfinite(found.error_s))[0])
    assert np.all(np.isfinite(found.error_s[first:]))
    recent = [
        (history.taken_s >= history.taken_s[k]) & (history.taken_s < history.taken_s[k] + 1.0) for k in (400, 800)
    ]
    settled = ~np.any(recent, axis=0)
    assert np.nanmax((off_s - 3.0 * found.error_s)[settled]) < _WAY_S


@pytest.mark.parametrize("faster", [1.03, 0.97])
def test_ticks_of_another_length_are_no_jump_of_nothing(faster: float) -> None:
    history = drawn(6)
    ticks = np.array(history.ticks[200:]) - history.ticks[200]
    history.ticks[200:] = [history.ticks[200] + round(faster * int(tick)) for tick in ticks]
    found = received(history, 0)
    assert not [gap for gap in found.gaps if gap.samples == 0 and "+0 s" in gap.why]
    assert not [gap for gap in found.gaps if gap.exact]


@pytest.mark.parametrize("bits", [24, 32, 40, 62])
@pytest.mark.parametrize("seed", [4, 5, 9])
def test_a_clock_that_shows_anything_from_the_start_moves_no_stamp(bits: int, seed: int) -> None:
    history = drawn(6)
    history.ticks[:] = [
        int(tick) for tick in np.random.default_rng(seed).integers(0, 1 << bits, len(history.ticks))
    ]
    off_s, found = _off_s(history, seed)
    assert off_s.max() < 2 * _WAY_S
    np.testing.assert_array_equal(found.number, FRAME * np.arange(len(history.ticks)))


@pytest.mark.parametrize("shown", [0, (1 << 62) + 1, (1 << 63) - 1, 1 << 63, (1 << 64) - 1])
def test_a_clock_at_its_largest_number_is_misread_once(shown: int) -> None:
    history = drawn(6)
    history.ticks[120] = shown
    off_s, found = _off_s(history)
    assert [(gap.samples, gap.exact) for gap in found.gaps] == [(0, False)]
    assert off_s.max() < 2 * _WAY_S


@pytest.mark.parametrize("last", [1, 100, 250])
def test_a_clock_that_begins_there_and_passes_zero_goes_on(last: int) -> None:
    history = drawn(6)
    by = (1 << 64) - 1 - history.ticks[last]
    history.ticks[:] = [(tick + by) % (1 << 64) for tick in history.ticks]
    off_s, found = _off_s(history)
    assert off_s.max() < 2 * _WAY_S
    np.testing.assert_array_equal(found.number, FRAME * np.arange(len(history.ticks)))
