"""Where a loss begins, a restart is one and a rate is believed: both sides of each limit of the ledger.

A tick a sample makes every limit a whole number: a step may be off by half a sample and a tick and a half, two
samples in all.
"""

import numpy as np
import pytest

from daemon.reception.sample_ledger import Gap, SampleLedger
from protocol.serial_frame import SamplesFrame, SamplesRun

HALF = 2**31


def frame(sequence: int, ticks: int, samples: int = 32) -> SamplesFrame:
    return SamplesFrame(sequence % 2**32, ticks, np.zeros((samples, 3), dtype=np.int16))


def run(sequence: int, ticks: list[int], samples: int = 32) -> SamplesRun:
    return SamplesRun(sequence, ticks, np.zeros((samples * len(ticks), 3), dtype=np.int16))


def ledger_after(first: SamplesFrame) -> SampleLedger:
    ledger = SampleLedger(1000.0, 1000.0)
    ledger.enter(first, 0)
    return ledger


@pytest.mark.parametrize(
    ("sequence", "step", "lost"),
    [
        (1, 32, 0),
        (1, 34, 0),
        (1, 35, 3),
        (1, 30, 0),
        (1, 0, 0),
        (2, 64, 32),
        (2, 70, 32),
        (2, 71, 39),
        (2, 57, 25),
    ],
)
def test_a_step_that_is_off_by_more_than_two_samples_is_a_loss(sequence: int, step: int, lost: int) -> None:
    """Behind 32 lost samples it may be off by 15 % of them and a ten-thousandth more: 6.8032 samples."""
    assert ledger_after(frame(0, 500)).missing(frame(sequence, 500 + step)) == lost


@pytest.mark.parametrize(
    ("sequence", "step", "doubted"),
    [(1, 32, False), (1, 34, False), (1, 35, True), (1, 30, False), (1, 29, True)]
    + [(2, 70, False), (2, 71, True), (2, 58, False), (2, 57, True), (3, 96, False), (1 + HALF, 32, True)]
    + [(2 + HALF, 32, False), (1, -2, False), (1, -1, True)],
)
def test_a_step_is_doubted_beyond_the_same_limit(sequence: int, step: int, doubted: bool) -> None:
    assert ledger_after(frame(0, 500)).doubts(frame(sequence, 500 + step)) == doubted


@pytest.mark.parametrize(
    ("elapsed", "missed", "counted"),
    [(0, 3, 3), (0, 4, 0), (10, 14, 14), (10, 15, 0), (-1, 2, 2), (-1, 3, 0), (10, 0, 0)],
)
def test_before_the_first_frame_no_more_is_missing_than_there_was_time_for(
    elapsed: int, missed: int, counted: int
) -> None:
    """As many samples as ticks, the frame's own one, two by rounding, and 15.01 % for a wrong rate."""
    ledger = SampleLedger(1000.0, 1000.0)
    ledger.pass_over(7, 500)
    assert ledger.missing(frame(8 + missed, 500 + elapsed, 1)) == counted


def test_before_the_first_frame_numbers_count_by_its_own_samples() -> None:
    ledger = SampleLedger(1000.0, 1000.0)
    ledger.pass_over(7, 500)
    ledger.pass_over(10, 500)  # two numbers are missing before this one, two behind it
    assert ledger.numbered(frame(13, 500, 5)) == 20
    assert ledger.missing(frame(13, 525, 5)) == 20
    later = ledger_after(frame(0, 500))
    assert later.numbered(frame(3, 500, 5)) == 64


@pytest.mark.parametrize(("skipped", "counts_on"), [(0, True), (5, True), (HALF, True), (HALF + 1, False)])
def test_numbers_half_way_round_are_the_last_that_go_on(skipped: int, counts_on: bool) -> None:
    ledger = ledger_after(frame(0, 500))
    ledger.pass_over(1 + skipped, 600)
    assert ledger.numbered(frame(2 + skipped, 532)) == 32 * skipped * counts_on
    direct = ledger_after(frame(0, 500))
    assert (direct.missing(frame(1 + skipped, 532)) is not None) == counts_on
    assert direct.begun_anew(frame(1 + skipped, 400)) != counts_on
    assert not direct.begun_anew(frame(1 + skipped, 499))  # by its clock it was not restarted


@pytest.mark.parametrize("first", [5, 2**32 - 3])
def test_steps_of_frames_that_follow_each_other_tell_the_rate(first: int) -> None:
    """Ten ticks in nine; frames of other numbers tell other rates."""
    ledger = ledger_after(frame(first, 0, 90))
    ledger.decide([frame(first + k, 100 * k, 90) for k in range(1, 7)] + [frame(first + 90, 650, 90)])
    assert ledger.step.ticks_per_sample == pytest.approx(10 / 9)


def test_the_samples_of_each_step_are_those_of_the_frame_before_it() -> None:
    ledger, ticks, frames = ledger_after(frame(0, 0, 100)), 0, []
    for k, samples in enumerate([100, 200, 50, 300, 100, 200]):
        ticks += round(1.1 * samples)
        frames.append(frame(k + 1, ticks, [200, 50, 300, 100, 200, 10][k]))
    ledger.decide(frames)
    assert ledger.step.measured and ledger.step.ticks_per_sample == pytest.approx(1.1)


@pytest.mark.parametrize(
    ("ticks", "goes_on"),
    [([34], True), ([35], False), ([30], True), ([29], False), ([32, 66], True), ([32, 67], False)]
    + [
        ([32, 62], True),
        ([32, 61], False),
        ([32, 64, 98], True),
        ([32, 64, 99, 128], False),
        ([32, 66, 96], True),
    ],
)
def test_a_run_goes_on_while_each_step_is_off_by_two_ticks_at_most(ticks: list[int], goes_on: bool) -> None:
    assert ledger_after(frame(0, 0)).goes_on(run(1, ticks)) == goes_on


def test_the_step_to_a_run_is_that_of_the_frame_before_it() -> None:
    ledger = ledger_after(frame(0, 0, 10))
    assert ledger.goes_on(run(1, [10, 42, 74])) and not ledger.goes_on(run(1, [32, 64, 96]))
    assert not ledger.goes_on(run(2, [10, 42])) and not SampleLedger(1000.0, 1000.0).goes_on(run(1, [10]))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_runs_measure_the_rate_and_its_jitter_as_frames_do(count: int) -> None:
    ledger = SampleLedger(8192.0, 2.0**20)  # 128 ticks a sample
    ledger.enter(frame(0, 0), 0)
    for k in range(6):
        first = 1 + k * count
        ledger.enter_run(run(first, [4096 * (first + i) for i in range(count)]))
    assert ledger.step.ticks_per_sample == 128.0
    assert ledger.step.tolerance_ticks == 65.5
    assert ledger.step.std == pytest.approx(1.5 / (6 * count * 4096))
    assert (ledger.samples, ledger.due_ticks) == (32 * (1 + 6 * count), 4096 * (6 * count + 1))
    assert ledger.in_sequence(frame(6 * count + 1, 0))


def test_five_frames_in_a_row_that_lost_as_much_tell_another_rate() -> None:
    ledger = ledger_after(frame(0, 0, 100))
    for k in range(1, 6):
        ledger.enter(frame(k, 110 * k, 100), 10)
    assert ledger.step.ticks_per_sample == pytest.approx(1.1)


@pytest.mark.parametrize(("sequence", "ticks"), [(7, 550), (5, -900)])
def test_frames_that_do_not_follow_tell_no_other_rate(sequence: int, ticks: int) -> None:
    ledger = ledger_after(frame(0, 0, 100))
    for k in range(1, 5):
        ledger.enter(frame(k, 110 * k, 100), 10)
    ledger.enter(frame(sequence, ticks, 100), 10)
    assert ledger.step.ticks_per_sample == 1.0


def test_a_restart_said_by_info_ends_with_the_first_frame() -> None:
    ledger = ledger_after(frame(0, 900))
    ledger.pass_over(1, 10)
    assert ledger.begun_anew(frame(2, 20))
    ledger.enter(frame(2, 20), 0)
    assert not ledger.begun_anew(frame(3, 5))


def test_a_rate_known_from_info_alone_resolves_no_frame_among_many() -> None:
    """A rate that is off by 15 % is off by a frame of 100 samples after 700."""
    ledger = SampleLedger(1000.0, 1000.0)
    assert not ledger.resolves(0, 100)
    ledger.enter(frame(0, 0, 100), 0)
    assert ledger.resolves(600, 100) and not ledger.resolves(700, 100)


def test_only_the_last_sixteen_gaps_are_kept() -> None:
    ledger = SampleLedger(1000.0, 1000.0)
    for k in range(20):
        ledger.note(Gap(k, 1, 0, "unplugged", True))
    assert [gap.sample0 for gap in ledger.gaps] == list(range(4, 20))
    assert ledger.causes["unplugged"] == 20


def test_before_the_first_samples_no_frame_is_doubted() -> None:
    ledger = SampleLedger(1000.0, 1000.0)
    assert not ledger.doubts(frame(7, 500))
    ledger.pass_over(6, 100)  # an INFO says its number and its clock, but no samples
    assert not ledger.doubts(frame(7, 9_999_500))
