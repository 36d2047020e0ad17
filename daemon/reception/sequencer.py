"""Frames in the order of their numbers: one that is early waits for those before it, one that is doubled goes."""

from collections import deque
from collections.abc import Sequence

from protocol.serial_frame import HALF_WAY, SEQUENCES, SamplesRun
from protocol.serial_parser import Found, Frame

#: Numbers further away than this are no disorder on the line, but much was lost, or the device counts anew.
_NEAR = 64
#: Frames that wait for one before them; then it is given up. A convention.
_WAITING = 4


class Sequencer:
    """Puts frames in order.

    Attributes
    ----------
    doubled : int
        Frames that came a second time.
    late : int
        Frames that came after they had been given up.
    """

    def __init__(self) -> None:
        self.doubled = 0
        self.late = 0
        self._due: int | None = None
        self._early: dict[int, Frame] = {}
        self._recent: deque[tuple[int, Sequence[int]]] = deque()  # frames in a row: the first's number, clocks
        self._kept = 0

    @property
    def waiting(self) -> int:
        """How many frames wait for one before them."""
        return len(self._early)

    def put(self, frame: Frame) -> list[Frame]:
        """Take a frame as it came; return those whose turn it is."""
        if self._due is None:
            return self._in_turn(frame)
        ahead = _signed(frame.sequence - self._due)
        if -_NEAR <= ahead < 0 and self._is_old(frame):
            return []
        if abs(ahead) > _NEAR or ahead < 0:
            return [*self.release(), *self._in_turn(frame)]
        if ahead == 0:
            return self._in_turn(frame)
        if frame.sequence in self._early:
            self.doubled += 1
            return []
        self._early[frame.sequence] = frame
        return self._given_up() if len(self._early) > _WAITING else []

    def take(self, found: Found) -> list[Frame | SamplesRun]:
        """Take frames as they came; return what `put` does, but a run in its turn, as most are, as it is."""
        if not isinstance(found, SamplesRun):
            return [*self.put(found)]
        if found.sequence != self._due or self._early:
            return [one for frame in found.frames() for one in self.put(frame)]
        self._note(found.sequence, found.ticks)
        return [found]

    def release(self) -> list[Frame]:
        """Give up what is missing and return all that waits for it."""
        released: list[Frame] = []
        while self._early:
            released += self._given_up()
        return released

    def _given_up(self) -> list[Frame]:
        assert self._due is not None
        due = self._due
        return self._in_turn(self._early.pop(min(self._early, key=lambda number: (number - due) % SEQUENCES)))

    def _in_turn(self, frame: Frame) -> list[Frame]:
        out = [frame]
        self._note(frame.sequence, [frame.ticks])
        while self._due in self._early:
            out.append(self._early.pop(self._due))
            self._note(out[-1].sequence, [out[-1].ticks])
        return out

    def _note(self, sequence: int, ticks: Sequence[int]) -> None:
        """Note frames in a row by their clocks; the first has the number ``sequence``."""
        self._due = (sequence + len(ticks)) % SEQUENCES
        self._recent.append((sequence, ticks))
        self._kept += len(ticks)
        while self._kept - len(self._recent[0][1]) >= 2 * _NEAR:
            self._kept -= len(self._recent.popleft()[1])

    def _is_old(self, frame: Frame) -> bool:
        """Say whether a frame with a passed number is one of this stream, and not of a device that counts anew."""
        clocks = self._clocks()
        if frame.sequence in clocks:
            if clocks[frame.sequence] != frame.ticks:
                return False
            self.doubled += 1
            return True
        before = [ticks for number, ticks in clocks.items() if _signed(frame.sequence - number) > 0]
        if before and frame.ticks < max(before):
            return False
        self.late += 1
        return True

    def _clocks(self) -> dict[int, int]:
        """Return the clocks of the last frames by their numbers."""
        recent = [((one + k) % SEQUENCES, tick) for one, ticks in self._recent for k, tick in enumerate(ticks)]
        return dict(recent[-2 * _NEAR :])


def _signed(difference: int) -> int:
    ahead = difference % SEQUENCES
    return ahead if ahead < HALF_WAY else ahead - SEQUENCES
