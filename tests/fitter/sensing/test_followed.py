"""A run that was followed: its times, motions and what was predicted, by numbers that are written down."""

from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.data.gaps import Gap
from fitter.data.raw import RawBlock, RawRun
from fitter.sensing import followed
from fitter.sensing.followed import Followed, follow, smoothed
from fitter.sensing.verdict import Verdict
from tracking.model.frames import Frames, Phase
from tracking.model.innovation_test import Consistency

RATE_HZ, FACTOR, N = 1000.0, 4, 400


def frames(first: int, n: int, q_std: float | None = None) -> Frames:
    """Return frames of one joint, each at the middle of its samples; the angle is the frame's number."""
    dt_s = FACTOR / RATE_HZ
    q = np.arange(first, first + n, dtype=float)[:, None]
    t0_ns = round(1e9 * (first * dt_s + 2.0 / RATE_HZ))
    std = None if q_std is None else np.full((n, 1), q_std)
    return Frames(first, t0_ns, dt_s, q, 2.0 * q, 3.0 * q, np.zeros((n, 3)), np.zeros((n, 1, 3)), False, std)


def run_of(*gaps: Gap) -> RawRun:
    """Return a run of one sensor and one gyroscope; each sample reads its number."""
    kept = N - sum(gap.samples for gap in gaps)
    lost_before = sum((np.arange(kept) >= gap.row) * gap.samples for gap in gaps)
    number = np.arange(kept) + lost_before
    a, w = np.tile(number[:, None], (1, 3)).astype(float), np.tile(-number[:, None], (1, 3)).astype(float)
    return RawRun("run", RATE_HZ, number / RATE_HZ, a, gaps, gyros=("s1",), w=w)


def test_frames_are_one_after_the_other() -> None:
    whole = Followed([frames(0, 3, 0.1), frames(5, 2, 0.2)], [], Verdict())
    np.testing.assert_allclose(whole.t, [0.002, 0.006, 0.010, 0.022, 0.026])
    for name, factor in (("q", 1.0), ("dq", 2.0), ("ddq", 3.0)):
        np.testing.assert_array_equal(whole.column(name)[:, 0], factor * np.array([0, 1, 2, 5, 6]))
    assert whole.q_std is not None
    np.testing.assert_array_equal(whole.q_std[:, 0], [0.1, 0.1, 0.1, 0.2, 0.2])
    assert Followed([frames(0, 3)], [], Verdict()).q_std is None


def test_a_motion_that_has_not_ended_is_none() -> None:
    phases = [Phase(kind, t_ns, k) for kind, t_ns, k in (("begin", 10**9, 1), ("end", 3 * 10**9, 1))]
    open_ended = [*phases, Phase("begin", 5 * 10**9, 2)]
    assert Followed([], open_ended, Verdict()).motions == [(1.0, 3.0)]
    assert Followed([], [], Verdict()).motions == []


@pytest.mark.parametrize(
    "gaps",
    [(), (Gap(40, 20),), (Gap(50, 7), Gap(52, 30), Gap(150, 1)), (Gap(0, 8),)],
    ids=["none", "one", "three", "first"],
)
def test_frames_whose_middle_sample_was_lost_were_predicted(gaps: tuple[Gap, ...]) -> None:
    run = run_of(*gaps)
    seen = np.zeros(N, dtype=bool)
    seen[np.round(run.t * RATE_HZ).astype(int)] = True
    whole = Followed([frames(0, 30), frames(40, 60)], [], Verdict())
    number = np.r_[0:30, 40:100]
    np.testing.assert_array_equal(whole.predicted(run), ~seen[FACTOR * number + FACTOR // 2])


class Told:
    """Stands for a tracker: notes what it is given, and gives out a frame each time."""

    def __init__(self) -> None:
        self.given: list[tuple[object, ...]] = []

    def push(self, t0_ns: int, values: np.ndarray) -> tuple[list[Frames], list[Phase]]:
        self.given.append(("push", t0_ns, values.copy()))
        return [frames(len(self.given), 1)], [Phase("begin", t0_ns, 1)]

    def gap(self, lost: int) -> tuple[list[Frames], list[Phase]]:
        self.given.append(("gap", lost))
        return [], []

    def flush(self) -> tuple[list[Frames], list[Phase]]:
        self.given.append(("flush",))
        return [frames(90, 7)], []

    def consistency(self) -> Consistency:
        return Consistency(0.5, 3, 1, True)


def test_a_tracker_is_given_every_sample_and_gap_in_turn() -> None:
    tracker, run = Told(), run_of(Gap(100, 25))
    found = follow(run, tracker)
    assert [one[0] for one in tracker.given] == ["push", "gap", "push", "flush"]
    (_, first_ns, first), (_, lost), (_, second_ns, second), _ = tracker.given
    assert (first_ns, lost, second_ns) == (0, 25, 125_000_000)
    values = np.vstack([first, second])
    np.testing.assert_array_equal(values, np.hstack([run.a, run.w]))
    assert [part.frame0 for part in found.frames] == [1, 3, 90] and len(found.phases) == 2
    assert found.verdict == Verdict(innovation=0.5, doubted=1.0 / 9.0, wrong=True)


def test_a_smoothed_run_is_on_the_runs_own_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    run, arm, q0 = run_of(), load_arm("dd-arm"), np.array([0.1])
    run = RawRun(run.name, run.rate_hz, run.t + 7.0, run.a, run.gaps, gyros=run.gyros, w=run.w)

    def smooth_motion(*given: object) -> SimpleNamespace:
        assert given[0] is arm and given[2] is q0
        assert given[1].values.shape == (100, 6) and given[1].dt_s == pytest.approx(0.004)
        return SimpleNamespace(
            frames=frames(0, 100), phases=[Phase("begin", 5, 1)], windows=("first", "last"), lengths=(30, 70)
        )

    said = {("first", 30): Verdict(doubted=0.1, wrong=False), ("last", 70): Verdict(doubted=0.0, wrong=True)}
    monkeypatch.setattr(followed, "smooth_motion", smooth_motion)
    monkeypatch.setattr(followed, "verdict_of", lambda *window: said[window])
    found = smoothed(run, arm, q0, 250.0)
    assert found.t[0] == pytest.approx(7.002) and found.phases == [Phase("begin", 7_000_000_005, 1)]
    assert found.verdict.doubted == pytest.approx(0.03) and found.verdict.wrong


def test_blocks_of_a_run_without_gyroscopes_have_none() -> None:
    run = run_of()
    plain = RawRun("run", RATE_HZ, run.t, run.a)
    blocks: Iterator[RawBlock] = plain.blocks()
    assert next(blocks).w.shape == (N, 0)
    tracker = Told()
    follow(plain, tracker)
    assert tracker.given[0][2].shape == (N, 3)
