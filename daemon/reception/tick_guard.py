"""A clock that jumps, stops or is misread, made into one that goes on: no tick is believed without reason.

A frame's number and the samples before it say what the clock is due to show, and the host's clock what it cannot
show yet. A frame that follows by number while its clock does not fit waits for the next one:

- the next fits again: the clock was misread once, such as a timer that is read in two halves;
- the next is as far off: the clock went on from there. It went ahead because samples were lost before they were
  numbered, if the host's clock allows for so much time. If it does not, or if the clock went back, it has jumped;
- the next is further ahead, and the host's clock allows that: samples were lost before either;
- the next is off by something else: the clock stands still, or shows anything; or, if a majority of steps in a
  row agree, it runs at another rate.

A misread clock shows what is due, and a jump is taken out of all that comes after it. Where frames are missing by
number a clock is believed that shows no less than the smallest of frames take, and no more than the largest; about
any other the host's clock decides at once.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import replace

from daemon.clock.tick_step import INFO_OFF, MAJORITY
from daemon.reception.info_requests import InfoRequests
from daemon.reception.sample_ledger import SampleLedger
from protocol.serial_frame import InfoFrame, SamplesFrame, SamplesRun

#: Enters a frame; the number is by how many ticks its clock was off, None where it was not.
Enter = Callable[[SamplesFrame, int | None], None]
#: Says by how much, beyond what is not known, something arrived before a tick was over [s]; below 0 if too late.
EarlyBy = Callable[[int], float]


class TickGuard:
    """Lets no frame pass whose clock cannot be right.

    Parameters
    ----------
    ledger : SampleLedger
        Knows the number and the clock that are due.
    requests : InfoRequests
        Knows how many of the missing numbers may be without samples.

    Attributes
    ----------
    shift : int
        What is added to the device's ticks.
    errors : int
        How often its clock was off: a clock that stands still is once.
    """

    def __init__(self, ledger: SampleLedger, requests: InfoRequests) -> None:
        self.shift = 0
        self.errors = 0
        self._ledger, self._requests = ledger, requests
        self._suspect: SamplesFrame | None = None
        self._steps: deque[tuple[int, int]] = deque(maxlen=MAJORITY)
        self._off = False

    @property
    def waiting(self) -> bool:
        """Whether a frame waits for the next one."""
        return self._suspect is not None

    @property
    def is_off(self) -> bool:
        """Whether the last frame's clock was off."""
        return self._off or self.waiting

    @property
    def arrived_ticks(self) -> int | None:
        """What the clock is due to show after all that arrived; None while a single frame is in doubt.

        A frame that waits while the clock is off takes its turn by number, whatever it turns out to have shown.
        """
        due = self._ledger.due_ticks
        if self._suspect is None or due is None:
            return due
        return due + round(len(self._suspect.counts) * self._ledger.step.ticks_per_sample) if self._off else None

    def shifted(self, run: SamplesRun) -> SamplesRun:
        """Return a run without the jumps of the clock so far."""
        return replace(run, ticks=[tick + self.shift for tick in run.ticks]) if self.shift else run

    def info(self, frame: InfoFrame) -> InfoFrame:
        """Return an INFO frame without them."""
        return replace(frame, ticks=frame.ticks + self.shift) if self.shift else frame

    def take(self, frame: SamplesFrame, early_s: EarlyBy, enter: Enter) -> None:
        """Take a frame as the device stamped it, and enter those of which it is known what their clock shows."""
        suspect, due = self._suspect, self._ledger.due_ticks
        frame = replace(frame, ticks=frame.ticks + self.shift)
        if suspect is not None and due is not None:
            if frame.sequence == self._ledger.number_after(suspect.sequence):
                self._by_next(suspect, due, frame, early_s, enter)
                return
            self.settle(early_s, enter)
            due = self._ledger.due_ticks
        if self._ledger.numbers_anew and early_s(self._end(frame)) != 0.0:  # that is not the clock of before
            self._ledger.restarted()
        if due is None or self._ledger.begun_anew(frame):
            self._pass(frame, enter)
        elif self._ledger.in_sequence(frame):
            if abs(frame.ticks - due) <= self._tolerance:
                self._pass(frame, enter)
            else:
                self._suspect = frame
        else:
            self._by_host(frame, due, early_s, enter)

    def settle(self, early_s: EarlyBy, enter: Enter) -> None:
        """Enter the frame that waits: what comes next will not tell of it."""
        suspect, due = self._suspect, self._ledger.due_ticks
        self._suspect = None
        if suspect is not None and due is not None:
            if suspect.ticks > due and early_s(self._end(suspect)) <= 0.0:
                self._pass(suspect, enter)
            else:
                self._due(suspect, due, enter)

    def _by_next(
        self, suspect: SamplesFrame, due: int, frame: SamplesFrame, early_s: EarlyBy, enter: Enter
    ) -> None:
        self._suspect = None
        off = suspect.ticks - due
        next_off = frame.ticks - due - round(len(suspect.counts) * self._ledger.step.ticks_per_sample)
        if abs(next_off) <= self._tolerance:
            self._due(suspect, due, enter)
            self._pass(frame, enter)
        elif off > 0 and next_off > off - self._tolerance and early_s(self._end(frame)) <= 0.0:
            self._pass(suspect, enter)
            if abs(frame.ticks - (self._ledger.due_ticks or 0)) <= self._tolerance:
                self._pass(frame, enter)
            else:  # more was lost after it, or something else happened
                self._suspect = frame
        elif abs(next_off - off) > self._tolerance:
            self._due(suspect, due, enter)
            self._steps.append((frame.ticks - suspect.ticks, len(suspect.counts)))
            if len(self._steps) == MAJORITY and self._ledger.step.changed(self._steps, 1.0 + INFO_OFF):
                off = frame.ticks - (self._ledger.due_ticks or 0)
                self.shift -= off
                self._ledger.step.begin(suspect.ticks - off)
                self._pass(replace(frame, ticks=frame.ticks - off), enter)
            else:
                self._suspect = frame
        else:
            self.shift -= off
            self._due(suspect, due, enter)
            self._pass(replace(frame, ticks=frame.ticks - off), enter)

    def _by_host(self, frame: SamplesFrame, due: int, early_s: EarlyBy, enter: Enter) -> None:
        """Enter a frame before which others are missing, by number or clock, as the host's clock allows."""
        ledger, p = self._ledger, self._ledger.step.ticks_per_sample
        missing = ledger.nearest_numbered(frame, (frame.ticks - due) / p)
        off = frame.ticks - due - round(missing * p)
        most = ledger.step.tolerance(missing) * p
        possible = self._is_possible(frame, off, most, early_s(self._end(frame)))
        if abs(off) <= most or possible or early_s(due + round(ledger.fewest_numbered(frame) * p)) > 0.0:
            self._pass(frame, enter)
        else:
            numbered = due + round(ledger.numbered(frame) * p)
            self.shift -= frame.ticks - numbered
            self._due(frame, numbered, enter)

    def _is_possible(self, frame: SamplesFrame, off: int, most: float, early_s: float) -> bool:
        """Say whether a clock can be right that does not agree with the numbers of missing frames.

        If it is ahead, samples were lost before they were numbered, unless the frame came too early for that. If
        it is behind by whole frames, INFO frames may be among those that are missing: as many as the device was
        asked for, or as somebody else asked for while it was away, however late a busy host read what came after
        them. That all of them were such, as a clock that stood still would have it, the host's clock must confirm.
        """
        ledger, requests, p = self._ledger, self._requests, self._ledger.step.ticks_per_sample
        if off > 0 or self._off:
            return off > 0 and early_s <= 0.0
        sizes, frames = ledger.sizes_with(frame), ledger.frames_before(frame)
        infos = sizes.without_samples(frames, round((frame.ticks - (ledger.due_ticks or 0)) / p))
        asked_for = infos is not None and (infos <= requests.unanswered or (requests.unplugged and infos < frames))
        in_time = early_s == 0.0 and -off <= requests.most * sizes.smallest * p + most
        return in_time or (asked_for and early_s <= 0.0)

    def _end(self, frame: SamplesFrame) -> int:
        return frame.ticks + round(len(frame.counts) * self._ledger.step.ticks_per_sample)

    @property
    def _tolerance(self) -> float:
        return self._ledger.step.tolerance_ticks

    def _pass(self, frame: SamplesFrame, enter: Enter) -> None:
        self._off = False
        self._steps.clear()
        enter(frame, None)

    def _due(self, frame: SamplesFrame, due: int, enter: Enter) -> None:
        """Enter a frame with the clock that is due; a clock that stays off is off once."""
        off = None if self._off else frame.ticks - due
        self.errors += not self._off
        self._off = True
        enter(replace(frame, ticks=due), off)
