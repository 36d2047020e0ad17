"""From bytes to accelerations: frames in order, every sample accounted for, runs of them without a hole."""

import time
from collections.abc import Callable, Sequence
from itertools import groupby
from operator import attrgetter

from daemon.acquisition.ring import Chunk, Mark
from daemon.clock.device_clock import Clock, DeviceClock
from daemon.clock.host_clock import HostClock
from daemon.clock.tick_counter import TickCounter
from daemon.reception.device_identity import DeviceIdentity
from daemon.reception.doubted_frames import DoubtedFrames
from daemon.reception.loss_attribution import LossAttribution
from daemon.reception.sample_ledger import Gap
from daemon.reception.sample_runs import Run, StepTimes
from daemon.reception.sequencer import Sequencer
from daemon.reception.timed_samples import KnownGap, NewClock, TimedSamples
from protocol.serial_frame import InfoFrame, SamplesFrame, SamplesRun
from protocol.serial_parser import Frame, FrameParser

#: A frame that waits for one before it waits no longer than this [ns].
_PATIENCE_NS = 20_000_000
#: Time without a byte that counts as silence [ns].
_SILENCE_NS = 300_000_000
#: Period in which the rate is reckoned anew [ns].
_LOOK_NS = 50_000_000
#: Time [ns] and number of frames from which the rate is known, whichever comes later.
_TO_KNOW_NS, _TO_KNOW_FRAMES = 250_000_000, 3


class Reception:
    """Turns what arrived into runs of accelerations.

    Parameters
    ----------
    parser : FrameParser
    introduction : InfoFrame
        The INFO by which counts are understood.
    host : HostClock, optional
    new_clock : callable, optional
        Returns a device's clock from its `tick_hz`, the ticks of a sample, the host's monotonic clock [ns] then,
        what UTC is ahead of that, and the host's seconds in one of the device's as far as they are known.
    steps : StepTimes, optional
        Knows the time from one sample to the next where that is not to be measured.
    known_gap : callable, optional
        Returns the gap right before the sample at a tick, if any, where that is not to be found out.

    Attributes
    ----------
    connected : bool
        Whether there is a port to read from.
    reconnects : int
        How often it came back.
    identity : DeviceIdentity
        Whether the device that is there is the run's.
    rate : SampleRate
        The device's rate, measured.
    """

    def __init__(
        self,
        parser: FrameParser,
        introduction: InfoFrame,
        host: HostClock | None = None,
        new_clock: NewClock = DeviceClock,
        steps: StepTimes | None = None,
        known_gap: KnownGap | None = None,
    ) -> None:
        self.info = introduction.info
        self.parser = parser
        self.sequencer = Sequencer()
        self.host = host or HostClock()
        self._losses = LossAttribution(parser.counters)
        self._timed = TimedSamples(self.info, self._losses, self.host, new_clock, steps, known_gap)
        self.ledger, self.requests, self.guard = self._timed.ledger, self._timed.requests, self._timed.guard
        self.rate, self.watch = self._timed.rate, self._timed.watch
        self._counter = TickCounter(self.info.tick_hz)
        self._doubted = DoubtedFrames()
        self._first_ns: int | None = None
        self._look_ns = 0
        self._error_ms: float | None = None
        self.identity = DeviceIdentity(self.info)
        self.connected = True
        self.reconnects = 0
        self._arrival_ns = 0
        self.sequencer.put(introduction)
        self.ledger.pass_over(introduction.sequence, introduction.ticks)

    @property
    def clock(self) -> Clock | None:
        """The device's clock, from the first frame on."""
        return self._timed.clock

    @property
    def awaits_info(self) -> bool:
        """Whether the device must say again what it is."""
        return not self.identity.known

    def knows_rate(self, now_ns: int) -> bool:
        """Say whether samples have come for long enough to know their rate, by the host's monotonic clock [ns]."""
        if self._first_ns is None:
            return False
        frames_ns = round(1e9 * _TO_KNOW_FRAMES * self.ledger.frame_samples / self.info.rate_hz)
        return now_ns >= self._first_ns + max(_TO_KNOW_NS, frames_ns)

    def take(self, chunks: Sequence[Chunk], now_ns: int | None = None) -> list[Run]:
        """Take what arrived, if anything, and return the samples whose turn it is."""
        data: list[Chunk] = []
        for chunk in chunks:
            if chunk.mark is Mark.DATA:
                data.append(chunk)
                continue
            self._parse(data)
            data = []
            if chunk.mark is Mark.ASKED:
                self.requests.sent(chunk.stamp_ns)
            elif chunk.mark is Mark.LOST:
                self._pass_on(self.sequencer.release(), chunk.stamp_ns)
                self._settle(chunk.stamp_ns)
                self._losses.why, self.connected = "unplugged", False
                self.requests.lost_device()
                self.identity.lost()
            else:
                self.parser.reset()
                self._losses.forget()
                self.identity.came_back()
                self.connected = True
                self.reconnects += 1
        if chunks:
            self._parse(data)
        elif self._waits and (now_ns or time.monotonic_ns()) > self._arrival_ns + _PATIENCE_NS:
            self._pass_on(self.sequencer.release(), self._arrival_ns)
            self._decide(self._arrival_ns)
        return self._timed.take()

    def finish(self) -> list[Run]:
        """Give up what is missing before the frames that still wait for it, and return their samples."""
        self._pass_on(self.sequencer.release(), self._arrival_ns)
        self._settle(self._arrival_ns)
        return self._timed.take()

    @property
    def _waits(self) -> bool:
        return self.sequencer.waiting > 0 or self.guard.waiting

    def new_gaps(self) -> list[Gap]:
        """Return the gaps since the last time."""
        return self._timed.new_gaps()

    def take_error_ms(self) -> float | None:
        """Return the largest standard error of the stamps since the last time [ms], None where none is known."""
        now_ms = None if self.clock is None else self.clock.state.error_ms
        largest_ms, self._error_ms = now_ms if self._error_ms is None else self._error_ms, now_ms
        return largest_ms

    def dropped(self) -> None:
        """Note that the daemon itself had no room for what came."""
        self._losses.why = "the daemon fell behind"

    def _parse(self, chunks: list[Chunk]) -> None:
        if not chunks:
            return
        arrival_ns = chunks[-1].stamp_ns
        found = self.parser.feed_runs(b"".join(chunk.data for chunk in chunks))
        self._losses.look()
        if self._losses.why is None and self._arrival_ns and arrival_ns - self._arrival_ns > _SILENCE_NS:
            self._losses.why = "the device was silent"
        steady = [self._counter.unwrapped(one, arrival_ns) for one in found]
        self._pass_on([frames for one in steady for frames in self.sequencer.take(one)], arrival_ns)
        self._arrival_ns = arrival_ns
        if self._first_ns is None and self.ledger.samples:
            self._first_ns = arrival_ns
        if self.clock is not None and (error_ms := self.clock.state.error_ms) is not None:
            self._error_ms = error_ms if self._error_ms is None else max(self._error_ms, error_ms)
        if self.clock is not None and arrival_ns >= self._look_ns:
            self.rate.look(self.ledger.step, self.clock.state)
            self._look_ns = arrival_ns + _LOOK_NS

    def _pass_on(self, passed: Sequence[Frame | SamplesRun], arrival_ns: int) -> None:
        """Enter frames in their order; those of a device that has come back wait until it said what it is."""
        last = next((one for one in reversed(passed) if not isinstance(one, InfoFrame)), None)
        for one in passed:
            if isinstance(one, SamplesRun) and self._goes_on(steady := self.guard.shifted(one)):
                self._timed.enter_run(steady, arrival_ns)
                continue
            if isinstance(last, SamplesRun):
                last = last.last()
            for frame in one.frames() if isinstance(one, SamplesRun) else [one]:
                self._pass_on_one(frame, last, arrival_ns)
        arrived_ticks = self.guard.arrived_ticks
        if last is None or not self.identity.known or self._doubted or arrived_ticks is None:
            return
        assert self.clock is not None
        self.clock.note(arrived_ticks, arrival_ns)

    def _pass_on_one(self, frame: Frame, last: SamplesFrame | None, arrival_ns: int) -> None:
        if isinstance(frame, InfoFrame):
            self._settle(arrival_ns)
            self._meet(self.guard.info(frame), arrival_ns)
        elif self.identity.holds_back(frame, arrival_ns):
            return
        elif self._doubted or self.ledger.doubts(frame):
            self._doubted.put(frame)
            if self._doubted.enough:
                self._settle(arrival_ns)
        else:
            self._guarded(frame, last or frame, arrival_ns)

    def _settle(self, arrival_ns: int) -> None:
        """Enter the frames that waited until the majority of them tells the ticks of a sample, or for the next."""
        doubted = self._doubted.take()
        if doubted:
            self.ledger.decide(doubted)
        for frame in doubted:
            self._guarded(frame, doubted[-1], arrival_ns)
        self._decide(arrival_ns)

    def _guarded(self, frame: SamplesFrame, last: SamplesFrame, arrival_ns: int) -> None:
        self.guard.take(
            frame, self._early_s(arrival_ns), lambda one, off: self._timed.enter(one, last, arrival_ns, off)
        )

    def _decide(self, arrival_ns: int) -> None:
        """Enter the frame whose clock is in doubt."""
        self.guard.settle(self._early_s(arrival_ns), lambda one, off: self._timed.enter(one, one, arrival_ns, off))

    def _early_s(self, arrival_ns: int) -> Callable[[int], float]:
        """Return what says by how much something arrived before a tick was over [s]."""

        def early_s(ticks: int) -> float:
            assert self.clock is not None  # only of frames after the first anything is asked
            return self.clock.early_s(ticks, arrival_ns)

        return early_s

    def _goes_on(self, run: SamplesRun) -> bool:
        """Say whether a run is of this device and goes on right where it was."""
        settled = not self._doubted and not self.guard.waiting
        return settled and self.identity.has(run.counts.shape[1]) and self.ledger.goes_on(run)

    def _meet(self, frame: InfoFrame, arrival_ns: int) -> None:
        self.requests.answered()
        waiting = self.identity.meet(frame.info)
        if self.identity.known:
            for came_ns, together in groupby(waiting, key=attrgetter("arrival_ns")):  # each by its own arrival
                self._pass_on([one.frame for one in together], came_ns)
            self._settle(arrival_ns)  # what waited comes before the INFO that it waited for
            self.ledger.pass_over(frame.sequence, frame.ticks)
