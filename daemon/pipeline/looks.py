"""When to look into the ring: right after the reader has written, so that nothing waits for a look by chance.

The reader wakes at a pace of its own, which the stamps of its chunks show. A look that comes as seldom but at any
time finds what has waited for up to as long; one that comes right after a write finds what was written just now.
"""

from collections.abc import Sequence

from daemon.acquisition.ring import Chunk

#: How long the ring may gather between two looks [ns]: what the reader, which gathers for 6 ms, reads in four
#: turns, two or three blocks. To wake costs a look as much as two blocks do: what it works with is in no cache any
#: more.
_GATHER_NS = 26_500_000
#: How long a look waits at the most for a reader whose turns are longer [ns]: USB converters bring bytes every
#: 16 ms, or now and then after twice as long.
_LONGEST_NS = 32_000_000
#: How long it waits for one that is late, or was never seen [ns]: a block's length.
_IDLE_NS = 10_000_000
#: A look comes so long after the reader is due [ns]: a sleep on a machine that is not busy is as exact.
_AFTER_NS = 200_000


class Looks:
    """Follows the pace of the reader."""

    def __init__(self) -> None:
        self._newest_ns: int | None = None
        self._due_ns = 0

    def wait_s(self, chunks: Sequence[Chunk], now_ns: int) -> float:
        """Return how long to wait for the next look, after one that found some chunks or none [s]."""
        if chunks:
            before_ns, self._newest_ns = self._newest_ns, chunks[-1].stamp_ns
            if before_ns is not None:
                pace_ns = max(self._newest_ns - before_ns, 1) / len(chunks)
                self._due_ns = round(self._newest_ns + max(1, _GATHER_NS // pace_ns) * pace_ns) + _AFTER_NS
        wait_ns = self._due_ns - now_ns
        return 1e-9 * (min(wait_ns, _LONGEST_NS) if wait_ns > 0 else _IDLE_NS)
