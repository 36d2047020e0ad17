"""Whatever frames are lost, every sample is accounted for."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from daemon.reception.sample_ledger import Gap, SampleLedger
from protocol.serial_frame import SamplesFrame, SamplesRun
from tests.daemon.reception.ledgers import after, entered, frame_at, frames


@given(
    kept=st.lists(st.booleans(), min_size=2, max_size=60),
    first=st.sampled_from([0, 5, 2**32 - 7]),
    tick_hz=st.sampled_from([1e3, 44_100.0, 1e6, 96e6]),
)
def test_samples_and_losses_add_up(kept: list[bool], first: int, tick_hz: float) -> None:
    kept = [True, *kept, True]
    ledger = SampleLedger(32000.0, tick_hz)
    for keep, frame in zip(kept, frames(len(kept), first, 32000.0, tick_hz), strict=True):
        if keep:
            before = ledger.position
            lost = entered(ledger, frame)
            assert ledger.position == before + lost + 32
    assert ledger.samples == 32 * sum(kept)
    assert ledger.lost_samples == 32 * (len(kept) - sum(kept))


def test_a_frame_without_samples_is_no_loss() -> None:
    one, _, three = frames(3, 0, 32000.0, 1e6)
    two_late = SamplesFrame(three.sequence, round(1000 + 1000), three.counts)  # its number was an INFO's
    ledger = SampleLedger(32000.0, 1e6)
    entered(ledger, one)
    ledger.pass_over(1, 2000)
    assert entered(ledger, two_late) == 0


def test_a_lost_info_is_no_loss_of_samples() -> None:
    one, _, three = frames(3, 0, 32000.0, 1e6)
    ledger = SampleLedger(32000.0, 1e6)
    entered(ledger, one)
    assert entered(ledger, SamplesFrame(three.sequence, round(1000 + 1000), three.counts)) == 0


def test_frames_missed_before_an_info_are_counted_once() -> None:
    every = frames(5, 0, 32000.0, 1e6)
    ledger = SampleLedger(32000.0, 1e6)
    entered(ledger, every[0])
    ledger.pass_over(3, every[3].ticks)  # frames 1 and 2 did not come
    assert entered(ledger, SamplesFrame(4, every[3].ticks, every[3].counts)) == 64
    after = SamplesFrame(5, every[4].ticks, every[4].counts)
    assert ledger.in_sequence(after)
    assert ledger.numbered(after) == 0


def test_what_was_missed_before_a_restart_is_not_missed_after_it() -> None:
    before, after = frames(1, 500, 32000.0, 1e6)[0], frames(1, 7, 32000.0, 1e6)[0]
    ledger = SampleLedger(32000.0, 1e6)
    entered(ledger, before)
    ledger.pass_over(503, before.ticks + 3000)
    ledger.pass_over(6, 0)
    assert ledger.numbered(after) == 0


def test_samples_that_the_device_lost_before_numbering_are_seen_by_its_clock() -> None:
    one, two = frames(2, 0, 32000.0, 1e6)
    ledger = SampleLedger(32000.0, 1e6)
    entered(ledger, one)
    assert entered(ledger, SamplesFrame(two.sequence, two.ticks + 5000, two.counts)) == 160


def test_a_slow_drift_of_the_rate_is_no_loss() -> None:
    ledger = SampleLedger(32000.0, 1e6)
    for k in range(2000):  # 100 ppm: a hundredth of a sample a frame, seven samples in all
        entered(ledger, SamplesFrame(k, round(k * 1000 * 1.0001), np.zeros((32, 12), dtype=np.int16)))
    assert ledger.lost_samples == 0


def test_a_clock_that_went_back_is_a_restart() -> None:
    one, two = frames(2, 0, 32000.0, 1e6)
    ledger = SampleLedger(32000.0, 1e6)
    entered(ledger, two)
    assert ledger.missing(one) is None


def test_numbers_that_begin_anew_are_a_restart() -> None:
    ledger = SampleLedger(32000.0, 1e6)
    entered(ledger, frames(1, 500, 32000.0, 1e6)[0])
    assert ledger.missing(SamplesFrame(1, 10**9, np.zeros((32, 12), dtype=np.int16))) is None


#: Frames in order before a run, so that the run itself hardly changes the rate that is measured.
BEFORE = 2000
ORDERLY = SamplesRun(1, [1000 * k for k in range(1, BEFORE)], np.zeros((32 * (BEFORE - 1), 12), dtype=np.int16))


@given(st.lists(st.integers(-600, 600), min_size=1, max_size=6), st.integers(-1, 2))
@example(
    jumps=[0, -61, 140], skipped=0
)  # a step that is hardly short enough, after one that is hardly long enough
def test_a_run_goes_on_where_none_of_its_frames_misses_samples(jumps: list[int], skipped: int) -> None:
    ticks = [int(t) for t in 1000 * (BEFORE + np.arange(len(jumps))) + np.cumsum(np.array(jumps) // 10)]
    run = SamplesRun(BEFORE + skipped, ticks, np.zeros((32 * len(ticks), 12), dtype=np.int16))
    whole, single = SampleLedger(32000.0, 1e6), SampleLedger(32000.0, 1e6)
    for ledger in (whole, single):
        ledger.enter(SamplesFrame(0, 0, np.zeros((32, 12), dtype=np.int16)), 0)
        ledger.enter_run(ORDERLY)
    goes_on = whole.goes_on(run)
    missing: list[int | None] = []
    for frame in run.frames():
        missing.append(single.missing(frame))
        single.enter(frame, missing[-1] or 0)
    assert not goes_on or all(lost == 0 for lost in missing)
    if all(abs(jump) < 10 * 15 for jump in jumps) and skipped == 0:  # less than half a sample of 31 ticks
        assert goes_on
    if goes_on:
        whole.enter_run(run)
        assert (whole.samples, whole.lost_samples, whole.position) == (single.samples, 0, single.position)
        assert whole.due_ticks == pytest.approx(single.due_ticks, abs=40)


@given(
    off=st.floats(-0.05, 0.05),
    samples=st.sampled_from([1, 32, 256, 2000]),
    tick_hz=st.sampled_from([1e3, 1e6, 10e6, 1e9]),
    lost=st.sets(st.integers(6, 78)),
)
@example(off=0.046875, samples=256, tick_hz=1e3, lost={6, 7, 8, 9})  # ticks too coarse to show the rate before
def test_a_rate_that_is_not_what_info_says_loses_nothing(
    off: float, samples: int, tick_hz: float, lost: set[int]
) -> None:
    sent = frames(80, 0, 32000.0 * (1.0 + off), tick_hz, samples)
    ledger, waiting = SampleLedger(32000.0, tick_hz), []
    for k, frame in enumerate(sent):
        if k in lost:
            continue
        if waiting or ledger.doubts(frame):
            waiting.append(frame)
        else:
            entered(ledger, frame)
        if len(waiting) == 6:
            ledger.decide(waiting)
            for one in waiting:
                entered(ledger, one)
            waiting.clear()
    if not waiting:
        assert ledger.lost_samples == samples * len(lost)
    span = sent[-1].ticks - sent[0].ticks
    if ledger.step.std is not None and not lost and span > 10_000:
        rate_hz = tick_hz / ledger.step.ticks_per_sample
        assert rate_hz == pytest.approx(32000.0 * (1.0 + off), rel=4.0 / span)


def test_a_rate_that_changes_is_a_rate_again() -> None:
    ledger, counts = SampleLedger(32000.0, 1e7), np.zeros((32, 12), dtype=np.int16)
    ticks = 0
    for k in range(400):
        entered(ledger, SamplesFrame(k, ticks, counts))
        ticks += 10_000 if k < 200 else 10_400
    assert ledger.lost_samples <= 5  # of as many frames as make a majority
    assert ledger.step.ticks_per_sample == pytest.approx(325.0, rel=1e-3)


def test_one_lost_sample_is_seen_whatever_the_rate() -> None:
    ledger, counts = SampleLedger(32000.0, 1e7), np.zeros((32, 12), dtype=np.int16)
    found = []
    for k in range(100):
        step = 325.0 * 32 * k + (325.0 if k > 50 else 0.0)
        frame = SamplesFrame(k, round(step), counts)
        if ledger.doubts(frame):
            ledger.decide([frame, SamplesFrame(k + 1, round(step + 325 * 32), counts)])
        found.append(entered(ledger, frame))
    assert {k: lost for k, lost in enumerate(found) if lost} == {51: 1}


def test_before_the_first_frame_nothing_is_due() -> None:
    ledger = SampleLedger(8000.0, 1e6)
    assert (ledger.position, ledger.due_ticks, ledger.frame_samples) == (0, None, 0)
    one = frame_at(7, 1000)
    assert ledger.missing(one) == 0 and ledger.numbered(one) == 0
    assert not (ledger.in_sequence(one) or ledger.follows(one) or ledger.begun_anew(one) or ledger.doubts(one))


def test_the_next_sample_is_due_behind_the_last_frame() -> None:
    ledger = after(frame_at(7, 1000))
    assert (ledger.position, ledger.due_ticks, ledger.frame_samples) == (32, 5000, 32)
    ledger.enter(frame_at(8, 5000, 10), 5)
    assert (ledger.position, ledger.due_ticks, ledger.frame_samples) == (47, 6250, 10)
    assert (ledger.samples, ledger.lost_samples) == (42, 5)


@pytest.mark.parametrize("last", [7, 2**32 - 1])
def test_numbers_follow_each_other_through_zero(last: int) -> None:
    ledger = after(frame_at(last, 1000))
    assert ledger.number_after(last) == (last + 1) % 2**32
    for ahead, follows in ((0, False), (1, True), (2, False)):
        frame = frame_at(last + ahead, 5000)
        assert ledger.in_sequence(frame) == ledger.follows(frame) == follows
    assert [ledger.numbered(frame_at(last + ahead, 0)) for ahead in (1, 2, 4)] == [0, 32, 96]


def test_an_info_in_between_takes_a_number_and_no_sample() -> None:
    ledger = after(frame_at(7, 1000))
    ledger.pass_over(9, 5000)  # number 8 did not come
    frame = frame_at(10, 9000)
    assert ledger.follows(frame) and not ledger.in_sequence(frame)
    assert ledger.numbered(frame) == ledger.missing(frame) == 32
    ledger.enter(frame, 32)
    assert ledger.in_sequence(frame_at(11, 13_000))


def test_a_device_that_counts_anew_after_its_info_has_lost_nothing() -> None:
    ledger = after(frame_at(1000, 900_000))
    ledger.pass_over(0, 100)
    assert ledger.begun_anew(frame_at(1, 200))
    assert ledger.missing(frame_at(1, 200)) is None and ledger.numbered(frame_at(1, 200)) == 0
    assert not ledger.begun_anew(frame_at(1, 904_000))  # its clock went on
    other = after(frame_at(1000, 900_000))
    assert other.begun_anew(frame_at(5, 200)) and not other.begun_anew(frame_at(1001, 200))


def test_before_the_first_frame_no_more_is_lost_than_time_allows() -> None:
    for missed, counted in ((0, 0), (3, 96), (4, 96 + 32), (6, 0)):
        ledger = SampleLedger(8000.0, 1e6)
        ledger.pass_over(10, 1000)
        assert ledger.missing(frame_at(11 + missed, 1000 + 3 * 4000)) == counted


def test_steps_across_missing_frames_do_not_measure_the_rate() -> None:
    """Frames that follow by number say 110 ticks a sample; what is between the others says nothing."""
    ledger = after(frame_at(0, 1000))
    stamps = [(k, 1000 + 32 * 110 * k) for k in range(1, 8)]
    gap = [(k + 50, 1000 + 32 * 110 * 7 + 900_000 + 32 * 110 * k) for k in range(1, 4)]
    ledger.decide([frame_at(sequence, ticks) for sequence, ticks in (*stamps, *gap)])
    assert ledger.step.measured and ledger.step.ticks_per_sample == pytest.approx(110.0)
    backwards = after(frame_at(0, 10_000_000))
    backwards.decide([frame_at(1, 1000), *(frame_at(k, 1000 + 32 * 110 * (k - 1)) for k in range(2, 8))])
    assert backwards.step.ticks_per_sample == pytest.approx(110.0)


def test_where_most_frames_are_missing_the_others_measure_the_rate() -> None:
    ledger = after(frame_at(0, 1000))
    ledger.decide([frame_at(k, 1000 + 32 * 110 * k) for k in (1, 3, 5, 7, 9, 11)])
    assert ledger.step.ticks_per_sample == pytest.approx(110.0)


def test_a_frame_is_doubted_until_the_rate_is_measured() -> None:
    ledger = after(frame_at(0, 1000))
    assert not ledger.doubts(frame_at(1, 5000))
    assert ledger.doubts(frame_at(1, 1000 + 8000)) and ledger.doubts(frame_at(1, 1001))
    assert not ledger.doubts(frame_at(3, 1000 + 3 * 4000))  # two are missing, by number and clock
    assert ledger.doubts(frame_at(3, 1000 + 9 * 4000))
    assert not ledger.doubts(frame_at(1, 0))  # that is a clock that went back
    assert not ledger.doubts(frame_at(-5, 900_000))  # and these are numbers that begin anew
    for k in range(1, 8):
        ledger.enter(frame_at(k, 1000 + 4000 * k), 0)
    assert not ledger.doubts(frame_at(8, 900_000))


def test_a_run_is_entered_as_its_frames_would_be() -> None:
    one, other = after(frame_at(0, 1000)), after(frame_at(0, 1000))
    for k in range(1, 6):
        one.enter(frame_at(k, 1000 + 4001 * k), 0)
    for first, count in ((1, 3), (4, 1), (5, 1)):
        ticks = [1000 + 4001 * k for k in range(first, first + count)]
        run = SamplesRun(first, ticks, np.zeros((32 * count, 12), dtype=np.int16))
        assert other.goes_on(run)
        other.enter_run(run)
    for name in ("position", "due_ticks", "frame_samples", "samples", "lost_samples"):
        assert getattr(one, name) == getattr(other, name), name
    assert one.step.ticks_per_sample == pytest.approx(other.step.ticks_per_sample)
    assert one.in_sequence(frame_at(6, 0)) and other.in_sequence(frame_at(6, 0))


def test_gaps_are_counted_by_their_cause() -> None:
    ledger = SampleLedger(8000.0, 1e6)
    for k in range(3):
        ledger.note(Gap(k, 1, 0, "unplugged", True))
    ledger.note(Gap(9, 0, 0, "the host's clock was set by +1.000 s", True), "the host's clock was set")
    assert ledger.causes == {"unplugged": 3, "the host's clock was set": 1}
    assert [gap.sample0 for gap in ledger.gaps] == [0, 1, 2, 9]
