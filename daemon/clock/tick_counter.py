"""A device's tick counter that passes zero, made into one that does not.

A counter of 32 bits at 10 MHz is back at zero after 429 s. What it stood at before and the host's clock together
say how often it has passed zero since; a device that was restarted stands at a number that they do not explain.
"""

from collections.abc import Sequence
from dataclasses import replace

from protocol.serial_frame import InfoFrame, SamplesRun
from protocol.serial_parser import Found

#: Ticks after which a counter of 32 bits passes zero.
_TURN = 1 << 32
#: The device's clock runs by no more than this off the host's [ratio].
_OFF = 0.25
#: … and its frames arrive by no more than this late [s]; with counters that turn quickly, by a quarter of a turn.
_LATE_S = 10.0


class TickCounter:
    """Counts the turns of a 32-bit counter; one that was beyond 32 bits is wider and has none.

    Parameters
    ----------
    tick_hz : float
    """

    def __init__(self, tick_hz: float) -> None:
        self._tick_hz = tick_hz
        self._late_ticks = min(_LATE_S * tick_hz, _TURN / 4)
        self._turned = 0
        self._wide = False
        self._last: int | None = None
        self._last_ns = 0

    def unwrapped(self, found: Found, arrival_ns: int) -> Found:
        """Return frames with the ticks of a counter that does not pass zero.

        Parameters
        ----------
        found : SamplesRun or InfoFrame
        arrival_ns : int
            Host's monotonic clock.
        """
        if isinstance(found, InfoFrame):  # whose clock is no sample's; it may be of another device
            return replace(found, ticks=found.ticks + self._turned) if self._turned else found
        ticks, shift = found.ticks, self.shift(found.ticks[0], arrival_ns)
        if shift == self._turned and (self._wide or _rises(ticks)):  # as nearly always: no turn is among them
            self._last = ticks[-1] + shift
            return SamplesRun(found.sequence, [tick + shift for tick in ticks], found.counts) if shift else found
        others = [tick + self.shift(tick, arrival_ns) for tick in ticks[1:]]
        return SamplesRun(found.sequence, [ticks[0] + shift, *others], found.counts)

    def shift(self, ticks: int, arrival_ns: int) -> int:
        """Return what is to be added to ``ticks`` of a frame that arrived then.

        Parameters
        ----------
        ticks : int
            As the frame has them.
        arrival_ns : int
            Host's monotonic clock.
        """
        self._wide = self._wide or ticks >= _TURN
        before, elapsed_s = self._last, 1e-9 * (arrival_ns - self._last_ns)
        if before is not None and not self._wide:
            due = before + elapsed_s * self._tick_hz
            if self._turned and ticks + self._turned - due > _TURN // 2:
                return self._turned - _TURN  # a frame from before the counter turned, which came after others
            turns = round((due - ticks - self._turned) / _TURN)
            now = ticks + self._turned + turns * _TURN
            if turns > 0 and now > before and abs(now - due) <= _OFF * (due - before) + self._late_ticks:
                self._turned += turns * _TURN
        self._last, self._last_ns = ticks + self._turned, arrival_ns
        return self._turned


def _rises(ticks: Sequence[int]) -> bool:
    """Say whether a counter goes on from each to the next, by less than half a turn in all."""
    return ticks[-1] < _TURN and ticks[-1] - ticks[0] <= _TURN // 2 and ticks == sorted(ticks)
