"""Runs of frames in the ledger: what each step between their ticks says of losses, rates and restarts."""

import numpy as np
import pytest

from daemon.reception.sample_ledger import SampleLedger
from protocol.serial_frame import SamplesFrame, SamplesRun
from tests.daemon.reception.ledgers import after, frame_at


def run_at(sequence: int, ticks: list[int], samples: int = 32) -> SamplesRun:
    return SamplesRun(sequence, ticks, np.zeros((samples * len(ticks), 12), dtype=np.int16))


def millis_after(first: SamplesFrame) -> SampleLedger:
    """Return a ledger into which one frame was entered; a tick a sample makes every limit a whole number."""
    return after(first, 1000.0, 1000.0)


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
def test_a_step_off_by_over_two_samples_is_a_loss(sequence: int, step: int, lost: int) -> None:
    """Behind 32 lost samples it may be off by 15 % of them and a ten-thousandth more: 6.8032 samples."""
    assert millis_after(frame_at(0, 500)).missing(frame_at(sequence, 500 + step)) == lost


def test_before_the_first_frame_numbers_count_by_its_own_samples() -> None:
    ledger = SampleLedger(1000.0, 1000.0)
    ledger.pass_over(7, 500)
    ledger.pass_over(10, 500)  # two numbers are missing before this one, two behind it
    assert ledger.numbered(frame_at(13, 500, 5)) == 20
    assert ledger.missing(frame_at(13, 525, 5)) == 20
    later = millis_after(frame_at(0, 500))
    assert later.numbered(frame_at(3, 500, 5)) == 64


def test_the_samples_of_each_step_are_those_of_the_frame_before_it() -> None:
    ledger, ticks, frames = millis_after(frame_at(0, 0, 100)), 0, []
    for k, samples in enumerate([100, 200, 50, 300, 100, 200]):
        ticks += round(1.1 * samples)
        frames.append(frame_at(k + 1, ticks, [200, 50, 300, 100, 200, 10][k]))
    ledger.decide(frames)
    assert ledger.step.measured and ledger.step.ticks_per_sample == pytest.approx(1.1)


def test_the_step_to_a_run_is_that_of_the_frame_before_it() -> None:
    ledger = millis_after(frame_at(0, 0, 10))
    assert ledger.goes_on(run_at(1, [10, 42, 74])) and not ledger.goes_on(run_at(1, [32, 64, 96]))
    assert not ledger.goes_on(run_at(2, [10, 42])) and not SampleLedger(1000.0, 1000.0).goes_on(run_at(1, [10]))


def test_five_frames_in_a_row_that_lost_as_much_tell_another_rate() -> None:
    ledger = millis_after(frame_at(0, 0, 100))
    for k in range(1, 6):
        ledger.enter(frame_at(k, 110 * k, 100), 10)
    assert ledger.step.ticks_per_sample == pytest.approx(1.1)


@pytest.mark.parametrize(("sequence", "ticks"), [(7, 550), (5, -900)])
def test_frames_that_do_not_follow_tell_no_other_rate(sequence: int, ticks: int) -> None:
    ledger = millis_after(frame_at(0, 0, 100))
    for k in range(1, 5):
        ledger.enter(frame_at(k, 110 * k, 100), 10)
    ledger.enter(frame_at(sequence, ticks, 100), 10)
    assert ledger.step.ticks_per_sample == 1.0


def test_a_restart_said_by_info_ends_with_the_first_frame() -> None:
    ledger = millis_after(frame_at(0, 900))
    ledger.pass_over(1, 10)
    assert ledger.begun_anew(frame_at(2, 20))
    ledger.enter(frame_at(2, 20), 0)
    assert not ledger.begun_anew(frame_at(3, 5))


def test_a_rate_known_from_info_alone_resolves_no_frame_among_many() -> None:
    """A rate that is off by 15 % is off by a millis_frame of 100 samples after 700."""
    ledger = SampleLedger(1000.0, 1000.0)
    assert not ledger.resolves(0, 100)
    ledger.enter(frame_at(0, 0, 100), 0)
    assert ledger.resolves(600, 100) and not ledger.resolves(700, 100)
