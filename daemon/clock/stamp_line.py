"""The line by which a device's seconds become the host's: straight pieces, of which none is ever taken back.

Every piece rises, and each begins where the one before it ends, so stamps never go back. What has been stamped
stays: a better line is approached from there by a rate that differs a little. What nobody has asked for yet is
still free.
"""

import math
from bisect import bisect_right
from collections import deque
from typing import NamedTuple

#: A better line is approached within this time, by a rate that differs by no more than this [s, ratio].
_APPROACH_S, _MOST_OFF = 10.0, 1e-2
#: While stamps wait for arrivals that they are ahead of they go on by this fraction of the rate; a convention.
WAITING = 0.5
#: More pieces than are begun in the time for which samples wait for their stamps.
_PIECES = 1024


class _Piece(NamedTuple):
    device_s: float
    host_s: float
    rate: float

    def at(self, device_s: float) -> float:
        return self.host_s + self.rate * (device_s - self.device_s)


class StampLine:
    """Tells the host's seconds at a device's.

    Parameters
    ----------
    rate : float
        Host's seconds in one of the device's, to begin with; at 0 both are 0.
    """

    def __init__(self, rate: float) -> None:
        self._pieces: deque[_Piece] = deque([_Piece(0.0, 0.0, rate)], maxlen=_PIECES)
        self._asked_s: float | None = None

    def stamp(self, device_s: float) -> float:
        """Return the host's seconds, which stay so."""
        self._asked_s = device_s if self._asked_s is None else max(device_s, self._asked_s)
        return self.at(device_s)

    def at(self, device_s: float) -> float:
        """Return the host's seconds as they are now; what was not stamped may still change."""
        last = self._pieces[-1]
        if device_s >= last.device_s:
            return last.at(device_s)
        k = bisect_right(self._pieces, device_s, key=lambda piece: piece.device_s)
        return self._pieces[max(k - 1, 0)].at(device_s)

    def approach(self, rate: float, offset_s: float) -> float:
        """Go on towards ``offset_s + rate * device_s``; return how far that is away [s]."""
        if self._asked_s is None:
            self._pieces.clear()
            self._pieces.append(_Piece(0.0, offset_s, rate))
            return 0.0
        here_s = self.at(self._asked_s)
        missing_s = offset_s + rate * self._asked_s - here_s
        off = max(-_MOST_OFF, min(missing_s / _APPROACH_S, _MOST_OFF))
        self._go_on(_Piece(self._asked_s, here_s, rate + off))
        return abs(missing_s)

    def hold_back(self, device_s: float, most_s: float) -> None:
        """Let the host's seconds at ``device_s`` be no more than ``most_s``, as far as what was stamped allows."""
        if self.at(device_s) <= most_s:
            return
        if self._asked_s is None:
            self.catch_up(most_s - self.at(device_s))
            return
        if device_s <= self._asked_s:
            return
        here_s, rate = self.at(self._asked_s), self._pieces[-1].rate
        slow = max(WAITING * rate, (most_s - here_s) / (device_s - self._asked_s))
        waiting = _Piece(self._asked_s, here_s, slow)
        self._go_on(waiting)
        self._go_on(_Piece(device_s, waiting.at(device_s), rate))

    def catch_up(self, by_s: float) -> None:
        """Let all that was not stamped yet be later [s]."""
        last = self._pieces[-1]
        if self._asked_s is None:
            self._pieces[-1] = last._replace(host_s=last.host_s + by_s)
            return
        after_s = math.nextafter(self._asked_s, math.inf)
        self._go_on(_Piece(after_s, self.at(self._asked_s) + by_s, last.rate))

    def _go_on(self, piece: _Piece) -> None:
        while self._pieces and self._pieces[-1].device_s >= piece.device_s:
            self._pieces.pop()
        self._pieces.append(piece)
