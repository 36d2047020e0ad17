"""Frames at which a tracker knew an angle no more do not count, joint by joint."""

import numpy as np
import pytest

from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.data.uncertain_motion import with_uncertain_marked

N = 400
T = 0.01 * np.arange(N)


def moving(std: np.ndarray | None) -> Measured:
    """Return a motion of two joints by .5 and .05 rad rms, with what its tracker claims."""
    q = np.sqrt(2.0) * np.array([0.5, 0.05]) * np.sin(2.0 * np.pi * T / T[-1])[:, None]
    dq = np.gradient(q, 0.01, axis=0)
    columns = {"q": q, "dq": dq, "ddq": np.gradient(dq, 0.01, axis=0), "tau": q}
    return Measured("run/1", "run.mcap", 0, T, columns if std is None else {**columns, "q_std": std})


LOST = np.arange(N) == N // 2


def known(before: float, after: float) -> np.ndarray:
    """Return claims that grow in the middle, and stay."""
    return np.where(np.arange(N)[:, None] < N // 2, before, after) * np.ones(2)


@pytest.mark.parametrize("std", [None, known(1e-3, 1e-3), known(0.66, 0.66)])
def test_what_is_known_alike_all_along_is_left_as_it_is(std: np.ndarray | None) -> None:
    motion = moving(std)
    assert with_uncertain_marked(motion, LOST) is motion


def test_where_nothing_is_lost_a_tracker_s_doubts_are_its_own() -> None:
    motion = moving(known(0.001, 0.3))
    assert with_uncertain_marked(motion, np.zeros(N, dtype=bool)) is motion


@pytest.mark.parametrize(("error_rad", "second"), [(0.014, False), (0.018, True), (0.14, True)])
def test_a_tenth_of_the_motion_s_power_is_too_much(error_rad: float, second: bool) -> None:
    found = with_uncertain_marked(moving(known(0.3, np.hypot(0.3, error_rad))), LOST)  # 0.3 is an offset of all
    marked = found.columns.get("contradicted", np.zeros((N, 2)))
    assert not marked[:, 0].any() and not marked[: N // 2].any()
    assert bool(marked[N // 2 :, 1].all()) is second
    assert [note.kind for note in found.notes] == ["uncertain"] * second


def test_the_note_says_how_badly_and_when() -> None:
    found = with_uncertain_marked(moving(known(0.001, 0.3)), LOST)
    first, second = found.notes
    assert "q1 is known to no better than 0.3 rad or m in 200 of 400 frames after lost samples" in first.text
    assert (first.columns, second.columns) == (("q1",), ("q2",))
    assert (first.from_s, first.to_s) == (2.0, 3.99)


def test_its_torques_do_not_count() -> None:
    (trial,) = to_trials([with_uncertain_marked(moving(known(0.001, 0.1)), LOST)], cutoff_hz=np.inf)
    assert trial.counted[:, 0].all()  # of 0.5 rad
    assert trial.counted[: N // 2, 1].all() and not trial.counted[N // 2 :, 1].any()
