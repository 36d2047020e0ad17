"""Blocks of samples are the same however the stream was cut into runs."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from daemon.clock.device_clock import ClockState
from daemon.publishing.sample_blocks import SampleBlocks
from daemon.reception.sample_runs import FrameTimes, Run

RATE_HZ = 8000.0
FRAME = 32


def time_ns(sample: int) -> int:
    """Return the time by a clock that is not quite the device's."""
    return 10**18 + round(sample * 1e9 / RATE_HZ * (1 + 3e-5)) + sample % 7


class SampleClock:
    """Ticks once a sample."""

    state = ClockState(None, None, None)

    def utc_ns(self, ticks: int) -> int:
        return time_ns(ticks)

    def monotonic_ns(self, ticks: int) -> int:
        return time_ns(ticks) - 10**18

    def note(self, ticks: int, arrival_ns: int) -> None:
        pass


class EvenSteps:
    def dt_s(self, _ticks: int) -> float:
        return 1.0 / RATE_HZ


def runs_of(frames: list[int], cuts: set[int]) -> list[Run]:
    """Return runs of the frames whose numbers are given; a new one at each hole and at each cut."""
    runs: list[Run] = []
    group: list[int] = []
    for place, k in enumerate(frames):
        hole = place > 0 and k != frames[place - 1] + 1
        if group and (hole or place in cuts):
            runs.append(run_of(group, runs))
            group = []
        group.append(k)
    return [*runs, run_of(group, runs)]


def run_of(group: list[int], before: list[Run]) -> Run:
    due = before[-1].sample0 + len(before[-1].a) if before else FRAME * group[0]
    times = FrameTimes(FRAME * group[0], FRAME, [FRAME * k for k in group], SampleClock(), EvenSteps())
    a = np.arange(FRAME * group[0], FRAME * (group[-1] + 1), dtype=float)[:, None]
    return Run(FRAME * group[0] - due, FRAME * group[0], [times], a)


def test_a_block_is_given_out_as_soon_as_it_is_full() -> None:
    """Ten milliseconds are 80 samples, two frames and a half."""
    pieces, given_out = SampleBlocks(RATE_HZ), []
    before: list[Run] = []
    for k in range(5):
        before.append(run_of([k], before))
        given_out.append([piece.n for piece in pieces.add(before[-1])])
    assert given_out == [[], [], [80], [], [80]]


@given(st.sets(st.integers(0, 60), min_size=2), st.sets(st.integers(1, 60)))
def test_blocks_do_not_depend_on_the_runs(present: set[int], cuts: set[int]) -> None:
    frames = sorted(present)
    whole, cut = (
        [piece for run in runs for piece in pieces.add(run)] + pieces.flush()
        for pieces, runs in (
            (SampleBlocks(RATE_HZ), runs_of(frames, set())),
            (SampleBlocks(RATE_HZ), runs_of(frames, cuts)),
        )
    )
    assert [(p.sample0, p.t0_ns, p.lost, p.a.tobytes()) for p in whole] == [
        (p.sample0, p.t0_ns, p.lost, p.a.tobytes()) for p in cut
    ]
    np.testing.assert_array_equal(
        np.concatenate([p.a[:, 0] for p in whole]), [FRAME * k + i for k in frames for i in range(FRAME)]
    )
    assert all(p.a[0, 0] == p.sample0 and p.n <= 80 for p in whole)
    assert sum(p.lost for p in whole) == FRAME * (frames[-1] - frames[0] + 1 - len(frames))
    for piece in whole:
        assert abs(piece.t0_ns - time_ns(piece.sample0)) < 2_000


def test_stamps_do_not_go_back_where_those_of_frames_wait() -> None:
    """At 100 Hz each sample is a block, and a frame of eight that waits begins half a frame after the last one."""

    class WaitingClock(SampleClock):
        def utc_ns(self, ticks: int) -> int:
            return 10**18 + round(0.5e9 * ticks / 100.0)

    class SlowSteps:
        def dt_s(self, _ticks: int) -> float:
            return 0.01

    times = FrameTimes(0, 8, [0, 8, 16], WaitingClock(), SlowSteps())
    stamps = [block.t0_ns for block in SampleBlocks(100.0).add(Run(0, 0, [times], np.zeros((24, 1))))]
    assert len(stamps) == 24 and np.diff(stamps).min() > 0
