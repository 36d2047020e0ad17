"""Blocks hold the same rows as the pieces, whatever the pieces; a gap begins a new block."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.publishing.motion_blocks import (
    RawSamples,
    bridge_blocks,
    frame_blocks,
    frames_message,
    raw_block_size,
    raw_message,
    unbroken,
)
from protocol.plot import plot_rows, plot_step
from tracking.model.frames import Frames

DT_S = 1e-3
T0_NS = 1_700_000_000_000_000_000


def frames(first: int, n: int, gap: bool = False, claimed: bool = False) -> Frames:
    number = np.arange(first, first + n, dtype=float)
    two = np.stack([number, number + 0.5], axis=1)
    return Frames(
        first,
        T0_NS + round(first * DT_S * 1e9),
        DT_S,
        two,
        2 * two,
        3 * two,
        np.stack([number] * 3, axis=1),
        np.broadcast_to(number[:, None, None], (n, 4, 3)),
        gap,
        4 * two if claimed else None,
    )


@given(st.integers(1, 75), st.booleans(), st.booleans())
def test_cutting_keeps_the_rows(n: int, gap: bool, claimed: bool) -> None:
    blocks = frame_blocks(frames(7, n, gap, claimed))
    assert np.concatenate([block.q[:, 0] for block in blocks]).tolist() == list(range(7, 7 + n))
    for place, block in enumerate(blocks):
        assert 1 <= block.n <= 10
        assert_same_rows(block, frames(block.frame0, block.n, gap and place == 0, claimed))


def assert_same_rows(block: Frames, expected: Frames) -> None:
    assert (block.t0_ns, block.gap) == (expected.t0_ns, expected.gap)
    for name in ("q", "dq", "ddq", "tip", "points", "q_std"):
        np.testing.assert_array_equal(getattr(block, name), getattr(expected, name))


@pytest.mark.parametrize("n", [1, 10, 34])
def test_every_block_that_bridges_a_gap_is_marked(n: int) -> None:
    blocks = bridge_blocks(frames(7, n, gap=True, claimed=True))
    assert sum(block.n for block in blocks) == n
    assert max(block.n for block in blocks) <= 10
    for block in blocks:
        assert_same_rows(block, frames(block.frame0, block.n, gap=True, claimed=True))


@pytest.mark.parametrize(("rate_hz", "samples"), [(32_000.0, 320), (8000.0, 80), (150.0, 2), (20.0, 1)])
def test_blocks_of_samples_are_ten_milliseconds_long_or_one(rate_hz: float, samples: int) -> None:
    assert raw_block_size(rate_hz) == samples


def test_blocks_of_frames_are_ten_milliseconds_long() -> None:
    assert [block.n for block in frame_blocks(frames(0, 34))] == [10, 10, 10, 4]


def test_no_frames_are_no_block() -> None:
    assert frame_blocks(frames(3, 0)) == bridge_blocks(frames(3, 0, gap=True)) == []


def test_plot_has_a_hundred_rows_a_second() -> None:
    messages = [frames_message(block, "m") for k in range(250) for block in frame_blocks(frames(4 * k, 4))]
    rows = [row for message in messages for row in plot_rows(message, plot_step(message["dt_s"]))]
    assert len(rows) == 100
    assert rows[3] == {
        "ts": pytest.approx(1_700_000_000.03, abs=1e-6),
        **{"q1": 30.0, "q2": 30.5, "dq1": 60.0, "dq2": 61.0, "ddq1": 90.0, "ddq2": 91.5},
        **{"tipx": 30.0, "tipy": 30.0, "tipz": 30.0},
    }


def test_plot_has_what_the_tracker_claims() -> None:
    (row,) = plot_rows(frames_message(frames(20, 10, claimed=True), "m"), 10)
    assert (row["q_std1"], row["q_std2"]) == (80.0, 82.0)


def test_messages_have_the_fields_of_the_contract() -> None:
    assert set(frames_message(frames(0, 10), "integrate")) == {
        *("frame0", "t0_ns", "dt_s", "n", "method", "q", "dq", "ddq", "tip", "points", "gap")
    }
    claimed = frames_message(frames(0, 10, claimed=True), "filter")
    np.testing.assert_array_equal(claimed["q_std"], frames(0, 10, claimed=True).q_std)
    raw = raw_message(RawSamples(5, T0_NS, 1 / 32000, np.ones((7, 12)), 0))
    assert set(raw) == {"sample0", "t0_ns", "dt_s", "n", "a"}
    assert raw["a"].dtype == np.float32


def test_every_count_can_be_had_back_from_single_precision() -> None:
    counts = np.arange(-32768, 32768)
    scale = 5.0 * 9.80665 / 32768
    raw = raw_message(RawSamples(0, T0_NS, 1 / 32000, (counts * scale)[:, None], 0))
    np.testing.assert_array_equal(np.rint(raw["a"][:, 0] / scale), counts)


def test_blocks_go_together_until_one_follows_a_gap_or_another_rate() -> None:
    a = np.zeros((2, 1))
    blocks = [
        RawSamples(2 * k, 0, dt_s, a, lost)
        for k, (dt_s, lost) in enumerate([(1.0, 3), (1.0, 0), (1.0, 1), (2.0, 0)])
    ]
    assert [[one.sample0 for one in group] for group in unbroken(blocks)] == [[0, 2], [4], [6]]
    assert unbroken([]) == []
