"""The wire between a virtual device and its port, with what may be wrong on it."""

from collections import Counter
from collections.abc import Mapping

import numpy as np

from daemon.virtual_device.virtual_device import FrameFifo


class FaultyLine:
    """Passes frames on to the device's memory for its host; some are lost, doubled, damaged or swapped.

    Parameters
    ----------
    fifo : FrameFifo
    seed : int
        Draws what is hit.

    Attributes
    ----------
    acting : mapping of str to float
        The kinds of fault that act now, with their values.
    done : Counter of str
        Frames that each kind of fault has hit.
    """

    def __init__(self, fifo: FrameFifo, seed: int) -> None:
        self.acting: Mapping[str, float] = {}
        self.done: Counter[str] = Counter()
        self._fifo = fifo
        self._rng = np.random.default_rng([seed, 3])
        self._overtaken: bytes | None = None

    def put(self, frame: bytes) -> None:
        """Take a frame from the device."""
        for kind in ("unplug", "restart", "silent"):
            if kind in self.acting:
                self.done[kind] += 1
                return
        if self._happens("drop"):
            return
        if self._overtaken is None and self._happens("reorder"):
            self._overtaken = frame
            return
        self._send(frame)
        if self._happens("double"):
            self._send(frame)
        if self._overtaken is not None:
            overtaken, self._overtaken = self._overtaken, None
            self._send(overtaken)

    def rustle(self, elapsed_s: float) -> None:
        """Let garbage come for a while."""
        if "garbage" in self.acting:
            n = int(self._rng.poisson(self.acting["garbage"] * elapsed_s))
            self._fifo.put(self._rng.bytes(n))

    def cut(self) -> None:
        """Lose what has not left the device yet."""
        self._overtaken = None
        self._fifo.clear()

    def _send(self, frame: bytes) -> None:
        if "baud" in self.acting:
            self.done["baud"] += 1
            frame = self._rng.bytes(len(frame))
        elif "flip" in self.acting:
            hit = np.flatnonzero(self._rng.random(len(frame)) < self.acting["flip"])
            if len(hit):
                self.done["flip"] += 1
                turned = np.frombuffer(frame, dtype=np.uint8).copy()
                turned[hit] ^= (1 << self._rng.integers(0, 8, len(hit))).astype(np.uint8)
                frame = turned.tobytes()
        self._fifo.put(frame)

    def _happens(self, kind: str) -> bool:
        hit = kind in self.acting and bool(self._rng.random() < self.acting[kind])
        if hit:
            self.done[kind] += 1
        return hit
