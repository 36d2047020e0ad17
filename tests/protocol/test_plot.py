"""Rows for plotting programs: every n-th frame of the motion, whatever blocks it comes in."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocol.plot import plot_row_count, plot_rows, plot_step

DT_S, T0_NS = 0.002, 1_700_000_000_000_000_000


def block(frame0: int, n: int, **more: np.ndarray) -> dict[str, object]:
    k = np.arange(frame0, frame0 + n, dtype=float)
    two = np.column_stack([k, -k])
    motion = {"q": two, "dq": 10.0 * two, "ddq": 100.0 * two, "tip": np.column_stack([k, k + 0.1, k + 0.2])}
    return {"frame0": frame0, "t0_ns": T0_NS + 2_000_000 * frame0, "dt_s": DT_S, "n": n, **motion, **more}


def test_a_row_has_every_signal_by_its_name() -> None:
    (row,) = plot_rows(block(10, 5), 5)
    assert row.pop("ts") == pytest.approx(T0_NS / 1e9 + 0.020, abs=1e-6)
    assert row == {
        **{"q1": 10.0, "q2": -10.0, "dq1": 100.0, "dq2": -100.0, "ddq1": 1000.0, "ddq2": -1000.0},
        **{"tipx": 10.0, "tipy": 10.1, "tipz": 10.2},
    }


def test_what_the_tracker_claims_is_there_where_it_claims_it() -> None:
    (row,) = plot_rows(block(0, 1, q_std=np.array([[0.1, 0.2]])), 1)
    assert (row["q_std1"], row["q_std2"]) == (0.1, 0.2)
    (row,) = plot_rows(block(0, 1) | {"q_std": None}, 1)
    assert "q_std1" not in row


@given(sizes=st.lists(st.integers(1, 30), min_size=1, max_size=8), step=st.integers(1, 12))
def test_however_it_is_cut_the_same_frames_are_rows(sizes: list[int], step: int) -> None:
    rows, begin = [], 0
    for size in sizes:
        rows += (these := plot_rows(block(begin, size), step))
        assert len(these) == plot_row_count(begin, size, 0.01 / step)
        begin += size
    assert [row["q1"] for row in rows] == list(range(0, begin, step))
    assert [row["ts"] for row in rows] == pytest.approx([T0_NS / 1e9 + DT_S * k for k in range(0, begin, step)])


@pytest.mark.parametrize(
    ("dt_s", "step"),
    [(0.001, 10), (0.0009999, 10), (0.004, 3), (0.007, 2), (0.0025, 4), (0.01, 1), (0.05, 1), (1 / 32e3, 320)],
)
def test_a_hundred_rows_a_second_at_the_most(dt_s: float, step: int) -> None:
    assert plot_step(dt_s) == step and 1.0 / (step * dt_s) < 100.1
