"""Blocks of frames and of raw samples, and the messages that they become."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from arm.model import Floats
from tracking.model.frames import Frames

Fields = dict[str, Any]

#: Longest block [s], see docs/protocol.md.
BLOCK_S = 0.01


class RawSamples(NamedTuple):
    """Consecutive samples: number and time [ns] of the first, and ``a`` (n_sample, n_channel) [m/s^2].

    ``lost`` are missing before the first.
    """

    sample0: int
    t0_ns: int
    dt_s: float
    a: Floats
    lost: int

    @property
    def gap(self) -> bool:
        """Whether samples are missing before the first."""
        return self.lost > 0

    @property
    def n(self) -> int:
        """Number of samples."""
        return len(self.a)


def raw_block_size(rate_hz: float) -> int:
    """Return the number of samples in 10 ms."""
    return max(1, round(BLOCK_S * rate_hz))


def unbroken(blocks: Sequence[RawSamples]) -> list[list[RawSamples]]:
    """Return blocks in groups within which no sample is missing and the time between samples stays."""
    groups: list[list[RawSamples]] = []
    for block in blocks:
        if block.lost or not groups or block.dt_s != groups[-1][-1].dt_s:
            groups.append([])
        groups[-1].append(block)
    return groups


def frame_blocks(piece: Frames) -> list[Frames]:
    """Return frames as blocks of 10 ms at the most; only the first says that samples were lost before it."""
    size = max(1, round(BLOCK_S / piece.dt_s))
    if 0 < piece.n <= size:  # as nearly always: what a tracker makes of a block of samples
        return [piece]
    return [_cut_frames(piece, k, min(k + size, piece.n)) for k in range(0, piece.n, size)]


def bridge_blocks(piece: Frames) -> list[Frames]:
    """Return frames that were predicted across a gap as blocks of 10 ms, all of them marked."""
    return [replace(block, gap=True) for block in frame_blocks(piece)]


def frames_message(block: Frames, method: str) -> Fields:
    """Return the fields of `limb/frames`; ``q_std``, ``a`` and ``a_noise`` where the tracker gives them."""
    claimed = {} if block.q_std is None else {"q_std": block.q_std}
    felt = {} if block.readings is None else {"a": block.readings}
    if block.noise is not None:
        felt["a_noise"] = block.noise
    return {
        "frame0": block.frame0,
        "t0_ns": block.t0_ns,
        "dt_s": block.dt_s,
        "n": block.n,
        "method": method,
        "q": block.q,
        "dq": block.dq,
        "ddq": block.ddq,
        **claimed,
        "tip": block.tip,
        "points": block.points,
        **felt,
        "gap": block.gap,
    }


def raw_message(block: RawSamples) -> Fields:
    """Return the fields of `limb/raw`. Single precision holds every 16-bit count, so each can be had back."""
    return {
        "sample0": block.sample0,
        "t0_ns": block.t0_ns,
        "dt_s": block.dt_s,
        "n": block.n,
        "a": block.a.astype(np.float32),
    }


def _cut_frames(piece: Frames, begin: int, end: int) -> Frames:
    return Frames(
        frame0=piece.frame0 + begin,
        t0_ns=later(piece.t0_ns, begin, piece.dt_s),
        dt_s=piece.dt_s,
        q=piece.q[begin:end],
        dq=piece.dq[begin:end],
        ddq=piece.ddq[begin:end],
        tip=piece.tip[begin:end],
        points=piece.points[begin:end],
        gap=piece.gap and begin == 0,
        q_std=None if piece.q_std is None else piece.q_std[begin:end],
        readings=None if piece.readings is None else piece.readings[begin:end],
        noise=piece.noise,
    )


def later(t0_ns: int, rows: int, dt_s: float) -> int:
    """Return the time [ns] a number of rows later."""
    return t0_ns + round(rows * dt_s * 1e9)
