"""Sums of products of the torque regressor's rows, a million samples in a fifth of a second.

Rows are made a few samples at a time and summed while they are still in the processor's cache. Samples are added
one after the other in the order of time, so that sums don't depend on the portions in which samples come.
"""

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain
from arm.model import Floats
from arm.regressor import torque_rows
from arm.regressor_lanes import LANES
from limbcal.compiled import compiled

#: Samples whose rows are made at a time: of more, those of an arm of many joints would leave the cache.
_CHUNK = LANES

#: One block's gram, moment, power, row, torque and count, for every joint.
BlockSums = tuple[Floats, Floats, Floats, Floats, Floats, Floats]


@compiled
def add_motion(
    chain: Chain,
    columns: NDArray[np.intp],
    ends: NDArray[np.intp],
    q: Floats,
    dq: Floats,
    ddq: Floats,
    tau: Floats,
    moving: NDArray[np.bool_],
    gram: Floats,
    moment: Floats,
    power: Floats,
    row: Floats,
    torque: Floats,
    count: Floats,
) -> None:
    """Add every sample to the sums of its block; blocks lie between ``ends``, counted from the first sample."""
    n = q.shape[1]
    Y, w = np.zeros((_CHUNK, n, 12 * n)), np.empty(columns.size)
    for block in range(ends.size - 1):
        until = min(ends[block + 1], q.shape[0])
        sums = gram[block], moment[block], power[block], row[block], torque[block], count[block]
        for start in range(max(ends[block], 0), until, _CHUNK):
            stop = min(start + _CHUNK, until)
            torque_rows(chain, q[start:stop], dq[start:stop], ddq[start:stop], Y)
            for k in range(start, stop):
                for joint in range(n):
                    if moving[k, joint]:
                        for a in range(columns.size):
                            w[a] = Y[k - start, joint, columns[a]]
                        add_row(w, tau[k, joint], joint, sums)


@compiled
def add_equations(
    ends: NDArray[np.intp],
    rows: Floats,
    tau: Floats,
    moving: NDArray[np.bool_],
    gram: Floats,
    moment: Floats,
    power: Floats,
    row: Floats,
    torque: Floats,
    count: Floats,
) -> None:
    """Add rows that are there already, (n_sample, n_joint, n_base), where they count."""
    for block in range(ends.size - 1):
        sums = gram[block], moment[block], power[block], row[block], torque[block], count[block]
        for k in range(max(ends[block], 0), min(ends[block + 1], rows.shape[0])):
            for joint in range(rows.shape[1]):
                if moving[k, joint]:
                    add_row(rows[k, joint], tau[k, joint], joint, sums)


@compiled
def add_row(w: Floats, tau: float, joint: int, sums: BlockSums) -> None:
    """Add one equation ``w . p = tau``; of the Gram matrix only the lower triangle."""
    gram, moment, power, row, torque, count = sums
    power[joint] += tau * tau
    torque[joint] += tau
    count[joint] += 1.0
    for a in range(w.size):
        if w[a] != 0.0:  # a joint does not feel the links before it: half of W is zeros
            moment[joint, a] += w[a] * tau
            row[joint, a] += w[a]
            for b in range(a + 1):
                gram[joint, a, b] += w[a] * w[b]
