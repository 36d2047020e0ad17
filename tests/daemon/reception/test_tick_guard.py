"""A frame whose clock does not fit waits for the next one, which tells what happened."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.reception.info_requests import InfoRequests
from daemon.reception.sample_ledger import SampleLedger
from daemon.reception.tick_guard import TickGuard
from protocol.serial_frame import SamplesFrame

N, P = 10, 1000


def frame(number: int, off: int = 0, p: int = P) -> SamplesFrame:
    return SamplesFrame(number, number * N * p + off, np.zeros((N, 3), dtype=np.int16))


class Entered:
    """Enters what a guard lets pass, as the reception does."""

    def __init__(self, early_s: float = 0.0, p: int = P) -> None:
        self.ledger = SampleLedger(1000.0, 1000.0 * p)
        self.guard = TickGuard(self.ledger, InfoRequests())
        self.early_s = early_s
        self.ticks: list[int] = []
        self.off: list[int | None] = []
        for number in range(1, 10):
            self.take(frame(number, p=p))

    def take(self, *frames: SamplesFrame) -> None:
        for one in frames:
            self.guard.take(one, lambda _ticks: self.early_s, self.enter)

    def enter(self, one: SamplesFrame, off: int | None) -> None:
        self.ledger.enter(one, self.ledger.missing(one) or 0)
        self.ticks.append(one.ticks)
        self.off.append(off)


@given(off=st.integers(2 * P, 1 << 40), sign=st.sampled_from([-1, 1]))
def test_a_misread_clock_shows_what_is_due(off: int, sign: int) -> None:
    entered = Entered()
    entered.take(frame(10, sign * off))
    assert entered.guard.waiting and len(entered.ticks) == 9
    entered.take(frame(11))
    assert entered.ticks[9:] == [10 * N * P, 11 * N * P]
    assert entered.off[9:] == [sign * off, None]
    assert (entered.guard.shift, entered.guard.errors, entered.ledger.lost_samples) == (0, 1, 0)


@given(off=st.integers(2 * P, 1 << 40))
def test_a_clock_that_goes_ahead_without_time_is_taken_back(off: int) -> None:
    entered = Entered(early_s=1.0)
    entered.take(frame(10, off), frame(11, off), frame(12, off))
    assert entered.ticks[9:] == [k * N * P for k in (10, 11, 12)]
    assert (entered.guard.shift, entered.guard.errors, entered.ledger.lost_samples) == (-off, 1, 0)


@given(lost=st.integers(1, 10_000))
def test_samples_that_were_lost_before_they_were_numbered_are_lost_if_the_host_allows_it(lost: int) -> None:
    entered = Entered()
    entered.take(frame(10, lost * P), frame(11, lost * P))
    assert entered.ledger.lost_samples == lost
    assert (entered.guard.shift, entered.guard.errors) == (0, 0)


def test_losses_one_after_the_other_are_losses() -> None:
    entered = Entered()
    entered.take(frame(10, 3 * P), frame(11, 7 * P), frame(12, 7 * P))
    assert (entered.ledger.lost_samples, entered.guard.errors) == (7, 0)


def test_a_clock_that_stands_still_is_off_once() -> None:
    entered = Entered()
    entered.take(*(frame(number, -(number - 9) * N * P) for number in range(10, 40)), frame(40), frame(41))
    assert entered.ticks == [number * N * P for number in range(1, 42)]
    assert (entered.guard.errors, entered.ledger.lost_samples) == (1, 0)


@pytest.mark.parametrize(("early_s", "lost"), [(0.0, 50), (1.0, 20)])
def test_where_frames_are_missing_the_host_decides_between_number_and_clock(early_s: float, lost: int) -> None:
    entered = Entered()
    entered.early_s = early_s
    late = frame(12, 30 * P)
    entered.guard.take(late, lambda ticks: early_s if ticks > 12 * N * P + P else 0.0, entered.enter)
    assert entered.ledger.lost_samples == lost


def test_a_frame_that_waits_is_entered_when_nothing_follows() -> None:
    entered = Entered()
    entered.take(frame(10, -5 * N * P))
    entered.guard.settle(lambda _ticks: 0.0, entered.enter)
    assert not entered.guard.waiting
    assert entered.ticks[-1] == 10 * N * P


def test_a_clock_that_runs_at_another_rate_is_followed_after_a_majority_of_steps() -> None:
    entered = Entered(early_s=1.0)
    faster = [SamplesFrame(k, 9 * N * P + (k - 9) * N * P * 11 // 10, frame(k).counts) for k in range(10, 30)]
    entered.take(*faster)
    assert entered.ledger.step.ticks_per_sample == pytest.approx(1.1 * P)
    assert (entered.guard.errors, entered.ledger.lost_samples, entered.off[-1]) == (1, 0, None)
    assert len(entered.ticks) == 29 and np.all(np.diff(entered.ticks) > 0)


def test_what_arrived_is_known_but_for_a_frame_in_doubt() -> None:
    entered, behind = Entered(), -5 * N * P
    assert entered.guard.arrived_ticks == 10 * N * P
    entered.take(frame(10, behind))
    assert entered.guard.arrived_ticks is None and entered.guard.is_off
    entered.take(frame(11, behind - N * P))  # it stands still: frames take their turn by number
    assert entered.guard.waiting and entered.guard.arrived_ticks == 12 * N * P


@pytest.mark.parametrize(("early_s", "ticks"), [(0.0, 15), (1.0, 10)])
def test_a_frame_ahead_that_nothing_follows_is_as_the_host_allows(early_s: float, ticks: int) -> None:
    entered = Entered()
    entered.take(frame(10, 5 * N * P))
    entered.guard.settle(lambda tick: early_s if tick == 16 * N * P else 9.9, entered.enter)  # asked of its end
    assert entered.ticks[-1] == ticks * N * P


def test_a_few_steps_at_another_rate_change_nothing() -> None:
    entered = Entered(early_s=1.0)
    for k in range(10, 14):
        entered.take(SamplesFrame(k, 9 * N * P + (k - 9) * N * P * 11 // 10, frame(k).counts))
    assert entered.ledger.step.ticks_per_sample == P


@pytest.mark.parametrize(("off", "shown"), [(-300, -300), (-15 * P, 0)])
def test_where_frames_are_missing_a_clock_may_be_off_by_a_trifle(off: int, shown: int) -> None:
    entered = Entered()
    entered.take(frame(12, off))
    assert entered.ticks[-1] == 12 * N * P + shown and entered.ledger.lost_samples == 2 * N
    assert entered.guard.errors == (0 if shown else 1)


#: Ticks a sample, odd, so that the tolerance is a whole number: half a sample and what rounding does.
ODD, TOLERANCE = 1001, 502


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("beyond", [0, 1])
def test_a_clock_may_be_off_by_the_tolerance_and_no_more(beyond: int, sign: int) -> None:
    entered = Entered(p=ODD)
    assert entered.ledger.step.tolerance_ticks == TOLERANCE
    entered.take(frame(10, sign * (TOLERANCE + beyond), ODD))
    assert entered.guard.waiting == bool(beyond)


@pytest.mark.parametrize("beyond", [0, 1])
def test_the_next_frame_clears_up_a_clock_within_the_tolerance(beyond: int) -> None:
    entered = Entered(p=ODD)
    entered.take(frame(10, -5 * N * ODD, ODD), frame(11, -TOLERANCE - beyond, ODD))
    assert entered.guard.waiting == bool(beyond)
    assert entered.ticks[10:] == ([] if beyond else [11 * N * ODD - TOLERANCE])


@pytest.mark.parametrize("beyond", [0, 1])
def test_after_a_loss_the_next_frame_follows_within_the_tolerance(beyond: int) -> None:
    entered = Entered(p=ODD)
    entered.take(frame(10, 3 * ODD, ODD), frame(11, 3 * ODD + TOLERANCE + beyond, ODD))
    assert entered.ledger.lost_samples == 3
    assert entered.guard.waiting == bool(beyond)
