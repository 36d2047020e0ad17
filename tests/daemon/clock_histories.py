"""Histories of a device's clock that lies, and of what the daemon's reception makes of them."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from daemon.acquisition.ring import Chunk, Mark
from daemon.clock.host_clock import HostClock
from daemon.reception.reception import Reception
from daemon.reception.sample_ledger import Gap
from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import InfoFrame, encode_samples
from protocol.serial_parser import FrameParser

RATE_HZ, FRAME = 1000.0, 10
UTC_NS = 1_800_000_000_000_000_000
#: Batches of a reader, and what bytes wait for beyond that [s].
_BATCH_S, _DELAY_S = 0.006, 0.002
#: Halves of a timer that is read in two: widths in bits.
TORN = (16, 24, 32)


@dataclass
class History:
    """What a device sent in some seconds, and what it lied about.

    Attributes
    ----------
    taken_s : (n_frame,)
        When the first sample of each frame was taken, by the host's clock.
    ticks : (n_frame,)
    sent : (n_frame,) bool
        Which frames arrived.
    lies_s : list of float
        When the clock lied.
    """

    tick_hz: float
    taken_s: NDArray[np.float64]
    ticks: list[int]
    sent: NDArray[np.bool_]
    lies_s: list[float] = field(default_factory=list)


def drawn(seed: int, seconds: float = 4.0) -> History:
    """Return a history: torn reads, jumps, halts, a rate that changes by up to 10 %, and frames that are lost."""
    rng = np.random.default_rng(seed)
    tick_hz = float(rng.choice([1e6, 1e7, 1e8]))
    n = round(seconds * RATE_HZ / FRAME)
    rate = 1.0 + rng.uniform(-0.1, 0.1) * rng.integers(0, 2)
    step_s = np.full(n, FRAME / RATE_HZ * rate)
    lies = list[float]()
    if rng.random() < 0.3:
        k = int(rng.integers(n // 4, n))
        step_s[k:] *= 1.0 + rng.uniform(-0.1, 0.1)
        lies.append(float(step_s[:k].sum()))
    taken_s = np.concatenate([[0.0], np.cumsum(step_s)[:-1]])
    first = int(rng.integers(0, 1 << 40)) if rng.random() < 0.5 else int(rng.integers(0, 1 << 31))
    ticks = [first + round(k * FRAME / RATE_HZ * tick_hz) for k in range(n)]
    for _ in range(rng.integers(0, 4)):
        k, kind = int(rng.integers(1, n)), rng.integers(0, 3)
        lies.append(float(taken_s[k]))
        if kind == 0:
            ticks[k] = max(0, ticks[k] + int(rng.choice([-1, 1])) * (1 << int(rng.choice(TORN))))
        elif kind == 1:
            by = int(rng.choice([-1, 1]) * np.exp(rng.uniform(np.log(1e-3), np.log(1e4))) * tick_hz)
            ticks[k:] = [max(0, tick + by) for tick in ticks[k:]]
        else:
            last = min(n, k + int(rng.integers(1, n // 2)))
            ticks[k:last] = [ticks[k]] * (last - k)
            lies.append(float(taken_s[last - 1]))  # a clock that goes on shows a jump
    sent = np.ones(n, dtype=np.bool_)
    if rng.random() < 0.5:
        k = int(rng.integers(1, n - 1))
        sent[k : k + int(rng.integers(1, 20))] = False
    return History(tick_hz, taken_s, ticks, sent, lies)


@dataclass
class Outcome:
    """What was made of it: number and stamp [s, by the host] of each frame's first sample.

    ``error_s`` is the stated standard error of a stamp then, NaN where there was none.
    """

    number: NDArray[np.int64]
    stamp_s: NDArray[np.float64]
    error_s: NDArray[np.float64]
    gaps: list[Gap]
    lost: int


def held_back(history: History, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return when frames are handed over [s] by a line that stalls at times, and then is little or much faster.

    It passes them on in their order, at a rate from a thousandth to eight times above that of the samples.
    """
    made_s = history.taken_s + FRAME / RATE_HZ
    over_s = np.empty_like(made_s)
    begin_s = np.sort(rng.uniform(4.0, 0.8 * made_s[-1], rng.integers(1, 4)))
    end_s = begin_s + np.exp(rng.uniform(np.log(0.05), np.log(3.0), len(begin_s)))
    faster = np.exp(rng.uniform(0.001, np.log(8.0), len(begin_s)))
    last_s, gap_s = 0.0, 0.0
    for k, one_s in enumerate(made_s):
        at_s = max(float(one_s), last_s + gap_s)
        for stall in np.flatnonzero((begin_s <= at_s) & (at_s < end_s)):
            at_s, gap_s = float(end_s[stall]), FRAME / RATE_HZ / float(faster[stall])
        if at_s == one_s:  # nothing waits any more
            gap_s = 0.0
        over_s[k] = last_s = at_s
    return over_s


def received(history: History, seed: int, handed_over_s: NDArray[np.float64] | None = None) -> Outcome:
    """Return what the daemon's reception makes of a history that arrives in batches.

    Frames are handed over as soon as they are made, if nothing else is said.
    """
    rng = np.random.default_rng(seed)
    axes = tuple(Channel(f"s1{axis}", 1e-3, 0.0, 49.0) for axis in "xyz")
    info = DeviceInfo("liar", "1", "1", RATE_HZ, history.tick_hz, axes)
    begun_ns = 5_000_000_000
    now = [begun_ns]
    host = HostClock(lambda: now[0] + UTC_NS, lambda: now[0])
    reception = Reception(FrameParser(), InfoFrame(0, history.ticks[0], info), host)
    sent_s = history.taken_s + FRAME / RATE_HZ if handed_over_s is None else handed_over_s
    ready_s = sent_s + 1e-3 + rng.exponential(_DELAY_S, len(sent_s))
    arrives = np.ceil(np.maximum.accumulate(ready_s) / _BATCH_S) * _BATCH_S
    found, gaps = list[tuple[int, float, float]](), list[Gap]()

    def take(chunks: list[Chunk], now_ns: int) -> None:
        now[0] = now_ns
        for run in [*reception.take(chunks, now_ns)]:
            error_ms = reception.clock.state.error_ms if reception.clock is not None else None
            for times in run.times:
                for k, tick in enumerate(times.ticks):
                    stamp_s = 1e-9 * (times.clock.utc_ns(tick) - UTC_NS - begun_ns)
                    found.append((times.sample0 + k * times.frame_samples, stamp_s, 1e-3 * (error_ms or np.nan)))
        gaps.extend(reception.new_gaps())

    k = 0
    while k < len(arrives):
        last = int(np.searchsorted(arrives, arrives[k], side="right"))
        frames = [
            encode_samples(np.full((FRAME, 3), i, dtype=np.int16), (i + 1) % 65536, history.ticks[i])
            for i in range(k, last)
            if history.sent[i]
        ]
        stamp_ns = begun_ns + round(1e9 * arrives[k])
        take([Chunk(stamp_ns, b"".join(frames), Mark.DATA)] if frames else [], stamp_ns)
        k = last
    take([], now[0] + 1_000_000_000)
    number, stamp_s, error_s = (np.array(column) for column in zip(*found, strict=True))
    return Outcome(number.astype(np.int64), stamp_s, error_s, gaps, reception.ledger.lost_samples)
