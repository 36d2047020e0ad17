"""Instants at which a tracker knew a motion no more do not count, for any joint."""

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


def marked(motion: Measured, lost: np.ndarray = LOST) -> Measured:
    """Return a motion with what its tracker claims of its angles taken into account."""
    return with_uncertain_marked(motion, lost, {"q": motion.columns["q_std"]} if "q_std" in motion.columns else {})


def known(before: float, after: float) -> np.ndarray:
    """Return claims that grow in the middle, and stay."""
    return np.where(np.arange(N)[:, None] < N // 2, before, after) * np.ones(2)


@pytest.mark.parametrize("std", [None, known(1e-3, 1e-3), known(0.66, 0.66)])
def test_what_is_known_alike_all_along_is_left_as_it_is(std: np.ndarray | None) -> None:
    motion = moving(std)
    assert marked(motion) is motion


def test_where_nothing_is_lost_a_tracker_s_doubts_are_its_own() -> None:
    motion = moving(known(0.001, 0.3))
    assert marked(motion, np.zeros(N, dtype=bool)) is motion


@pytest.mark.parametrize(("error_rad", "second"), [(0.014, False), (0.018, True), (0.14, True)])
def test_a_tenth_of_the_motion_s_power_is_too_much(error_rad: float, second: bool) -> None:
    found = marked(moving(known(0.3, np.hypot(0.3, error_rad))))  # 0.3 is an offset of all
    guess = found.columns.get("contradicted", np.zeros((N, 2)))
    assert not guess[: N // 2].any()
    assert bool(guess[N // 2 :].all()) is second  # for both: what the second does moves the first, too
    assert [note.kind for note in found.notes] == ["uncertain"] * second


def test_the_note_says_how_badly_and_when() -> None:
    found = marked(moving(known(0.001, 0.3)))
    first, second = found.notes
    assert "the motion of joint 1 is a guess in 200 of 400 frames after lost samples" in first.text
    assert "q1 known to 0.3 rad or m at worst" in first.text
    assert (first.columns, second.columns) == (("q1",), ("q2",))
    assert (first.from_s, first.to_s) == (2.0, 3.99)


def test_its_torques_do_not_count() -> None:
    (trial,) = to_trials([marked(moving(known(0.001, 0.1)))], cutoff_hz=np.inf)
    assert trial.counted[: N // 2].all() and not trial.counted[N // 2 :].any()


def test_an_acceleration_that_is_a_guess_is_enough() -> None:
    motion = moving(None)
    std = np.sqrt(0.2) * np.std(motion.columns["ddq"], axis=0)
    found = with_uncertain_marked(motion, LOST, {"q": known(0.0, 1e-6), "ddq": known(0.0, 1.0) * std})
    assert found.columns["contradicted"][N // 2 :].all()
