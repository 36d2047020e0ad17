"""A frame whose clock does not fit waits for the next one, which tells what happened."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.reception.info_requests import InfoRequests
from daemon.reception.sample_ledger import SampleLedger
from daemon.reception.tick_guard import TickGuard
from protocol.serial_frame import InfoFrame, SamplesFrame, SamplesRun
from tests.daemon.conftest import device_info

#: Frames of ten samples, a thousand ticks each; a step may be off by 501 ticks.
N, P = 10, 1000
FRAME = N * P
#: Ticks a sample, odd, so that the tolerance is a whole number: half a sample and what rounding does.
ODD, TOLERANCE = 1001, 502


def frame(number: int, off: int = 0, p: int = P, n: int = N) -> SamplesFrame:
    return SamplesFrame(number, number * N * p + off, np.zeros((n, 3), dtype=np.int16))


class Guarded:
    """A guard behind nine frames, and what it enters from then on as the reception would.

    By the host's clock frames come early by ``early_s`` at the ticks named there, by ``otherwise_s`` at others.
    """

    def __init__(self, otherwise_s: float = 0.0, p: int = P) -> None:
        self.ledger = SampleLedger(1000.0, 1000.0 * p)
        self.requests = InfoRequests()
        self.guard = TickGuard(self.ledger, self.requests)
        self.early_s: dict[int, float] = {}
        self.otherwise_s = otherwise_s
        self.entered: list[tuple[int, int | None]] = []
        self.take(*(frame(number, p=p) for number in range(1, 10)))
        self.entered.clear()

    def take(self, *frames: SamplesFrame) -> None:
        for one in frames:
            self.guard.take(one, self.early, self.enter)

    def early(self, ticks: int) -> float:
        return self.early_s.get(ticks, self.otherwise_s)

    def enter(self, one: SamplesFrame, off: int | None) -> None:
        self.ledger.enter(one, self.ledger.missing(one) or 0)
        self.entered.append((one.ticks, off))


@given(off=st.integers(2 * P, 1 << 40), sign=st.sampled_from([-1, 1]))
def test_a_misread_clock_shows_what_is_due(off: int, sign: int) -> None:
    guarded = Guarded()
    guarded.take(frame(10, sign * off))
    assert guarded.guard.waiting and guarded.guard.is_off and guarded.entered == []
    guarded.take(frame(11))
    assert guarded.entered == [(10 * FRAME, sign * off), (11 * FRAME, None)]
    assert not guarded.guard.is_off
    assert (guarded.guard.shift, guarded.guard.errors, guarded.ledger.lost_samples) == (0, 1, 0)


@given(off=st.integers(2 * P, 1 << 40))
def test_a_clock_that_goes_ahead_without_time_is_taken_back(off: int) -> None:
    guarded = Guarded(otherwise_s=1.0)
    guarded.take(frame(10, off), frame(11, off), frame(12, off))
    assert [ticks for ticks, _ in guarded.entered] == [k * FRAME for k in (10, 11, 12)]
    assert (guarded.guard.shift, guarded.guard.errors, guarded.ledger.lost_samples) == (-off, 1, 0)


@given(lost=st.integers(1, 10_000))
def test_samples_lost_before_they_were_numbered_are_lost_if_there_was_time(lost: int) -> None:
    guarded = Guarded()
    guarded.take(frame(10, lost * P), frame(11, lost * P))
    assert guarded.ledger.lost_samples == lost
    assert (guarded.guard.shift, guarded.guard.errors) == (0, 0)


def test_losses_one_after_the_other_are_losses() -> None:
    guarded = Guarded()
    guarded.take(frame(10, 3 * P), frame(11, 7 * P))
    assert guarded.guard.waiting and guarded.ledger.lost_samples == 3
    guarded.take(frame(12, 7 * P))
    assert (guarded.ledger.lost_samples, guarded.guard.errors) == (7, 0)


def test_a_clock_that_stays_off_is_told_once_until_it_is_right_again() -> None:
    guarded = Guarded()
    guarded.take(*(frame(number, -(number - 9) * FRAME) for number in range(10, 40)), frame(40), frame(41))
    assert guarded.entered == [(10 * FRAME, -FRAME), *((number * FRAME, None) for number in range(11, 42))]
    assert (guarded.guard.errors, guarded.ledger.lost_samples) == (1, 0)
    guarded.take(frame(42, 5 * P), frame(43))
    assert guarded.guard.errors == 2 and guarded.entered[-2:] == [(42 * FRAME, 5 * P), (43 * FRAME, None)]


def test_a_jump_is_taken_out_of_all_that_comes_after_it() -> None:
    guarded, off = Guarded(), -7 * P
    run = SamplesRun(12, [12 * FRAME + off, 13 * FRAME + off], np.zeros((2 * N, 3), dtype=np.int16))
    info = InfoFrame(12, 500, device_info())
    assert guarded.guard.shifted(run) is run and guarded.guard.info(info) is info
    guarded.take(frame(10, off), frame(11, off))
    assert guarded.entered == [(10 * FRAME, off), (11 * FRAME, None)]
    assert guarded.guard.shifted(run).ticks == [12 * FRAME, 13 * FRAME]
    assert guarded.guard.info(info).ticks == 500 + 7 * P
    guarded.take(frame(12, off + 3 * P), frame(13, off + 3 * P))
    assert guarded.ledger.lost_samples == 3


@pytest.mark.parametrize(
    ("off", "unplugged", "end_s", "numbered_s", "shown"),
    [
        (5 * P, False, 0.0, 0.0, 5 * P),  # more was lost, and there was time for it
        (5 * P, False, 0.1, 0.0, 0),
        (5 * P, False, -0.1, -0.1, 5 * P),  # what was lost made the host late, too
        (-9 * P, True, -0.1, 0.0, 0),  # nobody asked for that INFO
        (-9 * P, False, 0.0, 0.0, 0),
        (-9 * P, True, 0.0, 0.0, -9 * P),  # an INFO is missing
        (-9 * P, True, 0.1, 0.0, 0),
        (-9 * P, False, 0.0, 0.1, -9 * P),  # for what is missing by number there was no time
        (-504, False, 0.0, 0.0, -504),  # 501.5 ticks, and three standard errors of 20 samples
        (-505, False, 0.0, 0.0, 0),
    ],
)
def test_where_numbers_are_missing_the_hosts_clock_decides(
    off: int, unplugged: bool, end_s: float, numbered_s: float, shown: int
) -> None:
    guarded = Guarded()
    guarded.requests.unplugged = unplugged
    guarded.early_s = {13 * FRAME + off: end_s, 12 * FRAME: numbered_s}
    guarded.take(frame(12, off))
    assert guarded.entered == [(12 * FRAME + shown, None if shown else off)]
    assert guarded.guard.shift == (0 if shown else -off)
    assert guarded.guard.errors == (0 if shown else 1)
    assert guarded.guard.is_off == (shown == 0)
    assert guarded.ledger.lost_samples == 2 * N + int(shown / P)


@pytest.mark.parametrize(
    ("ticks", "lost"),
    [
        (4 * P, 4),  # a frame like the smallest
        (7 * P, 7),
        (N * P, N),
        (4 * P - 600, N),  # the clock went back: as many as the frame before had
        (N * P + 600, N),
    ],
)
def test_a_clock_is_believed_between_the_smallest_and_the_largest_frame(ticks: int, lost: int) -> None:
    guarded = Guarded()
    guarded.take(frame(10, n=4), frame(11, 4 * P - FRAME))
    guarded.early_s = {12 * FRAME + 4 * P + ticks: 0.1}
    guarded.take(SamplesFrame(13, 11 * FRAME + 4 * P + ticks, np.zeros((N, 3), dtype=np.int16)))
    assert guarded.ledger.lost_samples == lost
    assert guarded.guard.errors == (ticks % P != 0)


@pytest.mark.parametrize("early_s", [0.0, -0.2])
@pytest.mark.parametrize(("infos", "shown"), [(1, True), (2, False)])
def test_no_more_infos_are_missing_than_were_not_answered(infos: int, shown: bool, early_s: float) -> None:
    """However late the host reads: an answer has no samples."""
    guarded = Guarded(early_s)
    guarded.requests.sent(0)
    guarded.take(frame(13, -infos * FRAME))
    assert guarded.entered == [((13 - infos * shown) * FRAME, None if shown else -infos * FRAME)]
    assert guarded.ledger.lost_samples == (3 - infos * shown) * N


def test_a_frame_behind_another_than_the_one_in_doubt_settles_that() -> None:
    guarded = Guarded()
    guarded.take(frame(10, -5 * P), frame(12))
    assert guarded.entered == [(10 * FRAME, -5 * P), (12 * FRAME, None)]
    assert guarded.ledger.lost_samples == N


def test_a_restart_is_passed_on_as_it_is() -> None:
    guarded = Guarded()
    guarded.take(SamplesFrame(1, 50, np.zeros((N, 3), dtype=np.int16)))
    assert guarded.entered == [(50, None)]


@pytest.mark.parametrize(("off", "early_s", "shown"), [(5 * P, 0.0, 5 * P), (5 * P, 0.1, 0), (-5 * P, 0.0, 0)])
def test_a_frame_that_nothing_follows_is_as_late_as_the_host_allows(off: int, early_s: float, shown: int) -> None:
    guarded = Guarded()
    guarded.take(frame(10, off))
    guarded.early_s = {11 * FRAME + off: early_s}  # asked of its end
    guarded.guard.settle(guarded.early, guarded.enter)
    assert guarded.entered == [(10 * FRAME + shown, None if shown else off)]
    assert not guarded.guard.waiting
    guarded.guard.settle(guarded.early, guarded.enter)
    assert len(guarded.entered) == 1


def test_what_arrived_is_known_but_for_a_frame_in_doubt() -> None:
    assert TickGuard(SampleLedger(1000.0, 1e6), InfoRequests()).arrived_ticks is None
    guarded, behind = Guarded(), -5 * FRAME
    assert guarded.guard.arrived_ticks == 10 * FRAME
    guarded.take(frame(10, behind))
    assert guarded.guard.arrived_ticks is None
    guarded.take(frame(11, behind - FRAME))  # it stands still: frames take their turn by number
    assert guarded.guard.waiting and guarded.guard.arrived_ticks == 12 * FRAME


@pytest.mark.parametrize(("steps", "p"), [(4, P), (20, 1.1 * P)])
def test_another_rate_is_followed_after_a_majority_of_steps(steps: int, p: float) -> None:
    guarded = Guarded(otherwise_s=1.0)
    guarded.take(*(frame(9 + k, -k * FRAME + k * FRAME * 11 // 10) for k in range(1, steps + 1)))
    assert guarded.ledger.step.ticks_per_sample == pytest.approx(p)
    assert (guarded.guard.errors, guarded.ledger.lost_samples) == (1, 0)
    assert np.all(np.diff([ticks for ticks, _ in guarded.entered]) > 0)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("beyond", [0, 1])
def test_a_clock_may_be_off_by_the_tolerance_and_no_more(beyond: int, sign: int) -> None:
    guarded = Guarded(p=ODD)
    assert guarded.ledger.step.tolerance_ticks == TOLERANCE
    guarded.take(frame(10, sign * (TOLERANCE + beyond), ODD))
    assert guarded.guard.waiting == bool(beyond)


@pytest.mark.parametrize(("first", "lost"), [(-5 * N * ODD, 0), (3 * ODD, 3)])
@pytest.mark.parametrize("beyond", [0, 1])
def test_the_next_frame_clears_up_what_is_within_tolerance(first: int, lost: int, beyond: int) -> None:
    guarded, sign = Guarded(p=ODD), 1 if lost else -1
    guarded.take(frame(10, first, ODD), frame(11, lost * ODD + sign * (TOLERANCE + beyond), ODD))
    assert guarded.ledger.lost_samples == lost
    assert guarded.guard.waiting == bool(beyond)
