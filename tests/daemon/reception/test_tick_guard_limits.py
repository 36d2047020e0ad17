"""Which clock counts where frames are missing, and what a jump does to all that comes after it."""

import numpy as np
import pytest

from daemon.reception.info_requests import InfoRequests
from daemon.reception.sample_ledger import SampleLedger
from daemon.reception.tick_guard import TickGuard
from protocol.serial_frame import InfoFrame, SamplesFrame, SamplesRun
from tests.daemon.conftest import device_info

#: Frames of ten samples, a thousand ticks each; a step may be off by 501 ticks.
N, P = 10, 1000
FRAME = N * P


def frame(number: int, off: int = 0) -> SamplesFrame:
    return SamplesFrame(number, number * FRAME + off, np.zeros((N, 3), dtype=np.int16))


class Guarded:
    """A guard behind nine frames, and what it enters from then on."""

    def __init__(self) -> None:
        self.ledger = SampleLedger(1000.0, 1e6)
        self.requests = InfoRequests()
        self.guard = TickGuard(self.ledger, self.requests)
        self.entered: list[tuple[int, int | None]] = []
        self.asked: list[int] = []
        self.early_s: dict[int, float] = {}
        self.otherwise_s = 0.0
        self.take(*(frame(number) for number in range(1, 10)))
        self.entered.clear()

    def take(self, *frames: SamplesFrame) -> None:
        for one in frames:
            self.guard.take(one, self.early, self.enter)

    def early(self, ticks: int) -> float:
        self.asked.append(ticks)
        return self.early_s.get(ticks, self.otherwise_s)

    def enter(self, one: SamplesFrame, off: int | None) -> None:
        self.ledger.enter(one, self.ledger.missing(one) or 0)
        self.entered.append((one.ticks, off))


@pytest.mark.parametrize(("off", "waits"), [(501, False), (502, True), (-501, False), (-502, True)])
def test_a_frame_waits_whose_clock_is_off_by_more_than_half_a_sample(off: int, waits: bool) -> None:
    guarded = Guarded()
    guarded.take(frame(10, off))
    assert guarded.guard.waiting == guarded.guard.is_off == waits
    assert guarded.entered == ([] if waits else [(10 * FRAME + off, None)])


@pytest.mark.parametrize("off", [501, -501])
def test_the_next_frame_tells_of_a_misread_clock_by_half_a_sample(off: int) -> None:
    guarded = Guarded()
    guarded.take(frame(10, 5 * P), frame(11, off))
    assert guarded.entered == [(10 * FRAME, 5 * P), (11 * FRAME + off, None)]
    assert not guarded.guard.is_off


@pytest.mark.parametrize(("early_s", "lost"), [(-1.0, 5), (0.0, 5), (1e-9, 0)])
def test_a_clock_that_went_ahead_is_believed_unless_the_frame_came_too_early(early_s: float, lost: int) -> None:
    guarded = Guarded()
    guarded.otherwise_s = early_s
    guarded.take(frame(10, 5 * P), frame(11, 5 * P))
    assert guarded.ledger.lost_samples == lost
    assert guarded.asked == [12 * FRAME + 5 * P]  # when the second frame was over
    assert guarded.guard.shift == (0 if lost else -5 * P)


def test_a_jump_is_taken_out_of_all_that_comes_after_it() -> None:
    guarded, off = Guarded(), -7 * P
    guarded.take(frame(10, off), frame(11, off))
    assert guarded.entered == [(10 * FRAME, off), (11 * FRAME, None)]
    run = SamplesRun(12, [12 * FRAME + off, 13 * FRAME + off], np.zeros((2 * N, 3), dtype=np.int16))
    assert guarded.guard.shifted(run).ticks == [12 * FRAME, 13 * FRAME]
    assert guarded.guard.info(InfoFrame(12, 500, device_info())).ticks == 500 + 7 * P
    guarded.take(frame(12, off + 3 * P), frame(13, off + 3 * P))
    assert guarded.ledger.lost_samples == 3


def test_without_a_jump_frames_are_passed_as_they_are() -> None:
    guard, run = Guarded().guard, SamplesRun(12, [5], np.zeros((N, 3), dtype=np.int16))
    info = InfoFrame(12, 500, device_info())
    assert guard.shifted(run) is run and guard.info(info) is info
    assert (guard.shift, guard.errors, guard.is_off, guard.waiting) == (0, 0, False, False)


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
def test_a_clock_is_believed_between_the_smallest_and_the_largest_of_frames(ticks: int, lost: int) -> None:
    guarded = Guarded()
    guarded.take(SamplesFrame(10, 10 * FRAME, np.zeros((4, 3), dtype=np.int16)))
    guarded.take(SamplesFrame(11, 10 * FRAME + 4 * P, np.zeros((N, 3), dtype=np.int16)))
    guarded.early_s = {12 * FRAME + 4 * P + ticks: 0.1}
    guarded.take(SamplesFrame(13, 11 * FRAME + 4 * P + ticks, np.zeros((N, 3), dtype=np.int16)))
    assert guarded.ledger.lost_samples == lost
    assert guarded.guard.errors == (ticks % P != 0)


@pytest.mark.parametrize(("infos", "shown"), [(1, True), (2, False)])
def test_no_more_infos_are_missing_than_were_not_answered(infos: int, shown: bool) -> None:
    guarded = Guarded()
    guarded.requests.sent(0)
    guarded.take(frame(13, -infos * FRAME))
    assert guarded.entered == [((13 - infos * shown) * FRAME, None if shown else -infos * FRAME)]


@pytest.mark.parametrize(("infos", "shown"), [(1, True), (2, False)])
def test_an_answer_has_no_samples_however_late_the_host_reads(infos: int, shown: bool) -> None:
    guarded = Guarded()
    guarded.requests.sent(0)
    guarded.otherwise_s = -0.2
    guarded.take(frame(14, -infos * FRAME))
    assert guarded.ledger.lost_samples == (4 - infos * shown) * N


@pytest.mark.parametrize("early_s", [-0.2, 0.0])
def test_samples_lost_before_they_were_numbered_may_be_read_late(early_s: float) -> None:
    guarded = Guarded()
    guarded.otherwise_s = early_s
    guarded.take(frame(12, 30 * P))
    assert guarded.ledger.lost_samples == 2 * N + 30 and guarded.guard.errors == 0


def test_a_frame_behind_another_than_the_one_in_doubt_settles_that() -> None:
    guarded = Guarded()
    guarded.take(frame(10, -5 * P), frame(12))
    assert guarded.entered == [(10 * FRAME, -5 * P), (12 * FRAME, None)]
    assert guarded.ledger.lost_samples == N


def test_a_restart_is_passed_on_as_it_is() -> None:
    guarded = Guarded()
    guarded.take(SamplesFrame(1, 50, np.zeros((N, 3), dtype=np.int16)))
    assert guarded.entered == [(50, None)]


def test_a_clock_that_stays_off_is_told_once_until_it_is_right_again() -> None:
    guarded = Guarded()
    guarded.take(*(frame(number, -(number - 9) * FRAME) for number in range(10, 14)), frame(14), frame(15))
    assert [off for _, off in guarded.entered] == [-FRAME, None, None, None, None, None]
    assert guarded.guard.errors == 1
    guarded.take(frame(16, 5 * P), frame(17))
    assert guarded.guard.errors == 2 and guarded.entered[-2:] == [(16 * FRAME, 5 * P), (17 * FRAME, None)]


def test_nothing_is_settled_where_nothing_waits() -> None:
    guarded = Guarded()
    guarded.guard.settle(guarded.early, guarded.enter)
    assert guarded.entered == [] and guarded.asked == []


@pytest.mark.parametrize(("off", "early_s", "shown"), [(5 * P, 0.0, 5 * P), (5 * P, 0.1, 0), (-5 * P, 0.0, 0)])
def test_a_frame_that_nothing_follows_is_as_late_as_the_host_allows(off: int, early_s: float, shown: int) -> None:
    guarded = Guarded()
    guarded.otherwise_s = early_s
    guarded.take(frame(10, off))
    guarded.guard.settle(guarded.early, guarded.enter)
    assert guarded.entered == [(10 * FRAME + shown, None if shown else off)]


def test_what_waits_while_the_clock_is_off_takes_its_turn_by_number() -> None:
    guarded = Guarded()
    assert guarded.guard.arrived_ticks == 10 * FRAME
    guarded.take(frame(10, -FRAME), frame(11, -2 * FRAME))
    assert guarded.guard.arrived_ticks == 12 * FRAME  # the frame that waits has ten samples
    assert TickGuard(SampleLedger(1000.0, 1e6), InfoRequests()).arrived_ticks is None


def test_after_losses_one_behind_the_other_the_last_waits_for_its_next() -> None:
    guarded = Guarded()
    guarded.take(frame(10, 3 * P), frame(11, 3 * P + 501))
    assert not guarded.guard.waiting and guarded.ledger.lost_samples == 3
    other = Guarded()
    other.take(frame(10, 3 * P), frame(11, 7 * P))
    assert other.guard.waiting and other.ledger.lost_samples == 3


@pytest.mark.parametrize(("percent", "followed"), [(14, True), (16, False)])
def test_a_clock_may_run_faster_by_what_an_oscillator_is_off(percent: int, followed: bool) -> None:
    guarded = Guarded()
    guarded.otherwise_s = 1.0
    for k in range(1, 30):
        ticks = 9 * FRAME + k * FRAME * (100 + percent) // 100
        guarded.take(SamplesFrame(9 + k, ticks, np.zeros((N, 3), dtype=np.int16)))
    p = guarded.ledger.step.ticks_per_sample
    assert p == (pytest.approx(P * (1.0 + percent / 100)) if followed else P)
    assert guarded.ledger.lost_samples == 0
    steps = np.diff([ticks for ticks, _ in guarded.entered])
    assert steps.min() > 0 and steps.max() < 2 * FRAME
