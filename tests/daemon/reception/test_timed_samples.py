"""Numbers, times and causes that samples get, frame by frame."""

import numpy as np
import pytest

from daemon.clock.host_clock import HostClock
from daemon.reception.loss_attribution import LossAttribution
from daemon.reception.sample_ledger import Gap
from daemon.reception.timed_samples import KnownGap, TimedSamples
from protocol.serial_frame import SamplesFrame, SamplesRun
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info

#: Ten samples a frame at 1 kHz; a tick is a microsecond. UTC is an hour ahead of the host's monotonic clock.
N, RATE_HZ, HOUR_NS, MS = 10, 1000.0, 3600 * 10**9, 10**6
FRAME = 10_000
START_NS = 50 * MS


def frame(number: int, ticks: int | None = None) -> SamplesFrame:
    return SamplesFrame(
        number, number * FRAME if ticks is None else ticks, np.full((N, 3), number, dtype=np.int16)
    )


class Timed:
    def __init__(self, known_gap: KnownGap | None = None) -> None:
        self.losses = LossAttribution(FrameParser().counters)
        info = device_info(RATE_HZ, ("s1x", "s1y", "s1z"))
        self.timed = TimedSamples(info, self.losses, HostClock(lambda: HOUR_NS, lambda: 0), known_gap=known_gap)

    def enter(self, *frames: SamplesFrame, off: int | None = None) -> None:
        for one in frames:
            self.timed.enter(one, one, START_NS + one.sequence * N * MS, off)

    def gaps(self) -> list[tuple[int, int, str, bool]]:
        return [(gap.sample0, gap.samples, gap.why, gap.exact) for gap in self.timed.new_gaps()]


def test_frames_that_follow_each_other_are_one_run_on_one_clock() -> None:
    one = Timed()
    one.enter(frame(1), frame(2), frame(3))
    (run,) = one.timed.take()
    assert (run.lost, run.sample0, run.a.shape) == (0, 0, (3 * N, 3))
    np.testing.assert_allclose(run.a[:, 0] / run.a[0, 0], np.repeat([1.0, 2.0, 3.0], N))
    first, last = run.times[0].before(0), run.times[-1].before(29)
    assert (first.sample, last.sample) == (0, 20) and first.dt_s == pytest.approx(1e-3)
    assert last.t_ns - first.t_ns == pytest.approx(20 * MS, abs=1000)
    assert first.t_ns == HOUR_NS + START_NS  # as late as the first frame allows, all of which was taken by then
    assert one.timed.take() == [] and one.gaps() == []


def test_what_is_missing_by_number_is_a_gap_with_its_cause() -> None:
    one = Timed()
    one.enter(frame(1), frame(2), frame(5))
    before, after = one.timed.take()
    assert (before.a.shape[0], after.lost, after.sample0) == (20, 20, 40)
    (gap,) = one.timed.new_gaps()
    assert (gap.sample0, gap.samples, gap.why, gap.exact) == (20, 20, "frames missing", True)
    assert gap.t_ns == pytest.approx(before.times[0].before(0).t_ns + 20 * MS, abs=1000)
    one.losses.why = "unplugged"
    one.enter(frame(7))
    one.enter(frame(9))
    assert one.gaps() == [(50, 10, "unplugged", True), (70, 10, "frames missing", True)]


def test_a_gap_that_is_known_is_not_found_out() -> None:
    known = {1 * FRAME: Gap(0, 64, 7, "damaged on the line", True), 4 * FRAME: Gap(84, 20, 8, "unplugged", False)}
    one = Timed(known.get)
    one.enter(frame(1), frame(2), frame(4))
    assert [(run.sample0, run.lost) for run in one.timed.take()] == [(64, 64), (104, 20)]
    assert one.timed.new_gaps() == [*known.values()]


def test_a_run_of_frames_goes_on_where_the_last_one_ended() -> None:
    one = Timed()
    one.enter(frame(1))
    one.timed.requests.lost_device()
    one.timed.enter_run(
        SamplesRun(2, [2 * FRAME, 3 * FRAME], np.ones((2 * N, 3), dtype=np.int16)), START_NS + 40 * MS
    )
    (run,) = one.timed.take()
    assert run.a.shape == (30, 3) and one.timed.ledger.position == 30
    assert not one.timed.requests.unplugged


def test_a_clock_that_was_off_is_a_gap_without_samples() -> None:
    one = Timed()
    one.enter(frame(1))
    one.enter(frame(2), off=2_500_000)
    assert one.gaps() == [(10, 0, "the device's clock jumped by +2.5 s", False)]


@pytest.mark.parametrize("lost", [0, N])
def test_a_number_without_samples_answers_a_request(lost: int) -> None:
    one = Timed()
    one.enter(frame(1), frame(2))
    one.timed.requests.sent(START_NS + 25 * MS)
    one.enter(frame(4, 3 * FRAME + lost * 1000))  # the clock distinguishes an INFO frame from one of samples
    assert one.gaps() == ([(20, N, "frames missing", True)] if lost else [])
    assert one.timed.ledger.lost_samples == lost
    assert one.timed.requests.unanswered == bool(lost)
