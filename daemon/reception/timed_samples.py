"""Where each sample stands in a run: its number, its time, and what is missing before it, with the cause."""

from collections.abc import Callable
from dataclasses import replace

from daemon.clock.device_clock import Clock, DeviceClock
from daemon.clock.host_clock import HostClock
from daemon.clock.sample_rate import SampleRate
from daemon.reception.channel_watch import ChannelWatch
from daemon.reception.info_requests import InfoRequests
from daemon.reception.loss_attribution import LossAttribution
from daemon.reception.sample_ledger import Gap, SampleLedger
from daemon.reception.sample_runs import CountedRuns, FrameTimes, Run, StepTimes
from daemon.reception.tick_guard import TickGuard
from protocol.device_info import DeviceInfo
from protocol.serial_frame import HALF_WAY, SEQUENCES, SamplesFrame, SamplesRun

NewClock = Callable[[float, int, int, int, float], Clock]
KnownGap = Callable[[int], Gap | None]

_JUMPED = "the device's clock jumped"


class TimedSamples:
    """Gives the samples of frames their numbers and times, in runs without a hole.

    Parameters
    ----------
    info : DeviceInfo
    losses : LossAttribution
        Knows why samples are missing.
    host : HostClock
    new_clock : callable
        Returns a device's clock, see `daemon.reception.reception.Reception`.
    steps : StepTimes, optional
        Knows the time from one sample to the next where that is not to be measured.
    known_gap : callable, optional
        Returns the gap right before the sample at a tick, if any, where that is not to be found out.

    Attributes
    ----------
    ledger : SampleLedger
    requests : InfoRequests
    guard : TickGuard
        Frames pass it before they are entered.
    rate : SampleRate
        The device's rate, measured.
    watch : ChannelWatch
    clock : Clock or None
        The device's, from the first frame on.
    """

    def __init__(
        self,
        info: DeviceInfo,
        losses: LossAttribution,
        host: HostClock,
        new_clock: NewClock = DeviceClock,
        steps: StepTimes | None = None,
        known_gap: KnownGap | None = None,
    ) -> None:
        self.ledger = SampleLedger(info.rate_hz, info.tick_hz)
        self.requests = InfoRequests()
        self.guard = TickGuard(self.ledger, self.requests)
        self.rate = SampleRate(info.rate_hz, info.tick_hz)
        self.watch = ChannelWatch(info.channels, info.rate_hz)
        self.clock: Clock | None = None
        self._info, self._losses, self._host, self._new_clock = info, losses, host, new_clock
        self._steps, self._known_gap = steps or self.rate, known_gap or (lambda _: None)
        self._counted = CountedRuns(self.watch)
        self._new_gaps: list[Gap] = []

    def take(self) -> list[Run]:
        """Return the runs since the last time."""
        return self._counted.take()

    def new_gaps(self) -> list[Gap]:
        """Return the gaps since the last time."""
        gaps, self._new_gaps = self._new_gaps, []
        return gaps

    def enter_run(self, run: SamplesRun, arrival_ns: int) -> None:
        """Enter frames that go on right where the last one ended."""
        assert self.clock is not None
        times = FrameTimes(self.ledger.position, run.frame_samples, run.ticks, self.clock, self._steps)
        self._counted.add(times, run.counts)
        self.ledger.enter_run(run)
        self._losses.why = None
        self.requests.samples_came(arrival_ns)

    def enter(self, frame: SamplesFrame, last: SamplesFrame, arrival_ns: int, off: int | None = None) -> None:
        """Enter a frame.

        Parameters
        ----------
        frame, last : SamplesFrame
            The frame, and the last one that came with it.
        arrival_ns : int
            When, by the host's monotonic clock [ns].
        off : int, optional
            By how many ticks its clock was off, if it was.
        """
        lost = self.ledger.missing(frame)
        begun_anew = lost is None
        known = self._known_gap(frame.ticks) if self.clock is None or lost else None
        if self.clock is None or lost is None:
            by_host = self._start_clock(frame, last, arrival_ns)
            lost = by_host if lost is None else lost
        assert self.clock is not None
        if known is not None:
            lost = known.samples
        t_ns = self.clock.utc_ns(frame.ticks) - round(1e9 * lost / self._rate_hz)
        if off is not None:
            self._note(Gap(self.ledger.position, 0, t_ns, _jumped(off / self._info.tick_hz), False), _JUMPED)
        sizes = self.ledger.sizes_with(frame)
        infos = sizes.without_samples(self.ledger.frames_before(frame), lost)
        by_number = infos is not None and infos <= self.requests.most
        if infos and by_number and not self.requests.unplugged:
            self.requests.answered(infos)
        if lost or begun_anew:
            why = (
                "the device was restarted" if begun_anew else self._losses.cause(lost, frame, self.ledger.follows)
            )
            # A clock that resolves the samples of a frame distinguishes it from an INFO frame, which has none.
            distinguished = not self.requests.most or self.ledger.resolves(lost, sizes.smallest)
            exact = by_number and distinguished and sizes.are_one and not begun_anew and not self.guard.is_off
            found = Gap(self.ledger.position, lost, t_ns, why, exact)
            self._note(found if known is None else replace(known, sample0=found.sample0))
        first = self.ledger.position + lost
        times = FrameTimes(first, len(frame.counts), [frame.ticks], self.clock, self._steps)
        self._counted.add(times, frame.counts, lost)
        self.ledger.enter(frame, lost)
        self._losses.why = None
        self.requests.samples_came(arrival_ns)

    def _note(self, gap: Gap, cause: str | None = None) -> None:
        self.ledger.note(gap, cause)
        self._new_gaps.append(gap)

    def _start_clock(self, first: SamplesFrame, last: SamplesFrame, arrival_ns: int) -> int:
        """Start a clock; return how many samples were lost since the one before it, by the host's clock.

        The last sample that came with the first one was taken, at the latest, when it arrived.
        """
        before, due = self.clock, self.ledger.due_ticks
        rate = 1.0 if before is None else before.state.rate
        frames = (last.sequence - first.sequence) % SEQUENCES  # by number: clocks may be off
        span_s = (frames * len(first.counts) * (frames < HALF_WAY) + len(last.counts)) / self._rate_hz
        first_ns = arrival_ns - round(1e9 * span_s)
        lost = 0
        if before is not None:
            assert due is not None
            ended_ns = before.monotonic_ns(due)
            lost = max(0, round((first_ns - ended_ns) * self._rate_hz / 1e9))
            first_ns = max(first_ns, ended_ns)
        self.clock = self._new_clock(self._info.tick_hz, first.ticks, first_ns, self._host.offset_ns, rate)
        return lost

    @property
    def _rate_hz(self) -> float:
        return self.rate.measured_hz or self._info.rate_hz


def _jumped(by_s: float) -> str:
    return f"{_JUMPED} by {by_s:+.3g} s"
