"""How many samples the frames of a device have: between which bounds those lie that never came."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class FrameSizes:
    """The sizes of the frames that were seen.

    Attributes
    ----------
    smallest, largest : float
        Samples of the smallest and of the largest; before any was seen, every size is smaller than the smallest.
    """

    smallest: float = math.inf
    largest: float = 0

    def with_frame(self, samples: int) -> "FrameSizes":
        """Return the sizes after one more frame."""
        if self.smallest <= samples <= self.largest:
            return self
        return FrameSizes(min(self.smallest, samples), max(self.largest, samples))

    @property
    def are_one(self) -> bool:
        """Whether all frames had as many samples."""
        return self.smallest == self.largest

    def nearest(self, frames: int, samples: float) -> float:
        """Return the number of samples that some frames can have had which is nearest to that of a clock."""
        return min(max(samples, frames * self.smallest), frames * self.largest)

    def without_samples(self, frames: int, samples: int) -> int | None:
        """Return the least number of frames without samples, where all frames together had some number of samples.

        Returns
        -------
        int or None
            None where no number of frames agrees with that of samples.
        """
        fewest = max(0, math.ceil(frames - samples / self.smallest))
        most = math.floor(frames - samples / self.largest)
        return fewest if fewest <= most else None
