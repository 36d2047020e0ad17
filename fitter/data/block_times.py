"""The times of samples that came in stamped blocks.

A block bears the stamp of its first sample and the step to the next one. While the daemon waits for arrivals
that its stamps are ahead of, a block may be stamped before the one before it would end by its step. Nothing is
missing then: the samples between two such stamps are as far apart as the stamps say.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from arm.model import Floats


def block_times(
    first: Sequence[int], count: Sequence[int], t0_ns: Sequence[int], step_s: Sequence[float]
) -> Floats:
    """Return the times of all samples of some blocks in their order, (n_sample,) [ns]; none is before another.

    Parameters
    ----------
    first, count : (n_block,) int
        Number of a block's first sample, and how many samples it has.
    t0_ns : (n_block,) int [ns]
        Stamps, which rise.
    step_s : (n_block,) [s]
    """
    steps = [1e9 * step for step in step_s]
    for k, (here, then) in enumerate(pairwise(t0_ns)):
        goes_on = first[k] + count[k] == first[k + 1]
        if goes_on and count[k] and then - here < count[k] * steps[k] - 0.5 * steps[k]:
            steps[k] = (then - here) / count[k]
    parts = [at + step * np.arange(n) for at, step, n in zip(t0_ns, steps, count, strict=True)]
    return np.concatenate(parts) if parts else np.zeros(0)
