"""How many numbers of lost frames may be those of INFO frames, which have no samples.

A device numbers an INFO frame as it numbers its samples. The daemon asks for one when it sends START; an answer
that is lost leaves a number without samples. While the device was unplugged anybody may have asked it.
"""

import math
from collections import deque

from daemon.acquisition.handshake import INFO_LIMIT_S

#: A device answers within this time, or the handshake gives it up [ns].
_ANSWER_NS = round(1e9 * INFO_LIMIT_S)


class InfoRequests:
    """Counts the requests for INFO that were not answered.

    Attributes
    ----------
    unplugged : bool
        Whether the device was away since the last samples.
    """

    def __init__(self) -> None:
        self.unplugged = False
        # A device that is silent is asked for as long as it is: those long overdue are counted alone.
        self._overdue = 0
        self._overdue_ns = 0
        self._sent_ns: deque[int] = deque()

    @property
    def unanswered(self) -> int:
        """How many INFO frames the device was asked for that did not come: it may have numbered them meanwhile."""
        return self._overdue + len(self._sent_ns)

    @property
    def most(self) -> float:
        """How many numbers before the next frame may be those of INFO frames."""
        return math.inf if self.unplugged else self.unanswered

    def sent(self, now_ns: int) -> None:
        """Note that the device was asked for an INFO frame, as by START, by the host's monotonic clock [ns]."""
        while self._sent_ns and self._sent_ns[0] < now_ns - _ANSWER_NS:
            self._overdue_ns = self._sent_ns.popleft()
            self._overdue += 1
        self._sent_ns.append(now_ns)

    def answered(self, infos: int = 1) -> None:
        """Note that INFO frames came, or that some numbers were theirs."""
        overdue = min(infos, self._overdue)
        self._overdue -= overdue
        for _ in range(min(infos - overdue, len(self._sent_ns))):
            self._sent_ns.popleft()

    def samples_came(self, arrival_ns: int) -> None:
        """Note when samples came: an answer to a request long before them has a number before theirs."""
        self.unplugged = False
        if self._overdue_ns < arrival_ns - _ANSWER_NS:
            self._overdue = 0
        while self._sent_ns and self._sent_ns[0] < arrival_ns - _ANSWER_NS:
            self._sent_ns.popleft()

    def lost_device(self) -> None:
        """Note that the device is away: what it was asked for will not be answered."""
        self.unplugged = True
        self._overdue = 0
        self._sent_ns.clear()
