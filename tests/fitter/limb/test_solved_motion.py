"""The motion of a recording as the kernels have it: what is missing is said, too little is refused."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.simulated_people.person import person, with_markers
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.solved_motion import solve_motion
from limbcal.errors import DataError


@pytest.fixture(scope="module")
def truth():
    return person(n=60)


def test_a_recording_of_something_else_is_an_error(truth):
    other = replace(truth.recordings[0], names=tuple(f"x{k}" for k in range(len(truth.recordings[0].names))))
    with pytest.raises(DataError, match="it has none"):
        solve_motion(with_markers(truth), other, 1)


def test_a_base_that_no_frame_shows_is_an_error(truth):
    recording, positions = truth.recordings[0], truth.recordings[0].positions.copy()
    positions[:, [name.startswith("B") for name in recording.names]] = np.nan
    with pytest.raises(DataError, match="no frame shows the base's markers"):
        solve_motion(with_markers(truth), replace(recording, positions=positions), 1)


def test_a_marker_that_is_not_there_is_said(truth):
    recording = truth.recordings[0]
    lost = next(name for name in recording.names if name.startswith("forearm"))
    kept = [k for k, name in enumerate(recording.names) if name != lost]
    less = replace(
        recording, names=tuple(recording.names[k] for k in kept), positions=recording.positions[:, kept]
    )
    solved = solve_motion(with_markers(truth), less, 1)
    assert [note.columns for note in solved.notes if note.kind == "missing_marker"] == [(lost,)]
    away = np.degrees(np.abs(solved.smoothed.q[:, solved.marked.markers.sway :] - truth.q[0]))
    assert np.median(away) < 1.0


def test_frames_in_which_the_base_is_hidden_are_said_and_bridged(truth):
    recording, positions = truth.recordings[0], truth.recordings[0].positions.copy()
    base = [name.startswith("B") for name in recording.names]
    positions[20:35, base] = np.nan
    solved = solve_motion(with_markers(truth), replace(recording, positions=positions), 1)
    (note,) = [note for note in solved.notes if note.kind == "base_gap"]
    assert "in 15 of 60 frames" in note.text
    assert np.isfinite(solved.smoothed.q).all()


def test_frames_in_which_nothing_is_seen_are_said(truth):
    recording, positions = truth.recordings[0], truth.recordings[0].positions.copy()
    positions[20:35] = np.nan
    positions[40:43] = np.nan  # 0.06 s: shorter than is reported
    solved = solve_motion(with_markers(truth), replace(recording, positions=positions), 1)
    (note,) = [note for note in solved.notes if note.kind == "gap"]
    assert "in 15 of 60 frames (0.30 s at the longest)" in note.text and (note.from_s, note.to_s) == (0.4, 0.7)
    assert not [note for note in solve_motion(with_markers(truth), recording, 1).notes if note.kind == "gap"]


def test_base_markers_by_other_names_are_named(truth):
    recording = truth.recordings[0]
    base = tuple(name.lower() if name.startswith("B") else name for name in recording.names)
    with pytest.raises(DataError, match="it has none of the base's markers .*did you mean 'b"):
        solve_motion(with_markers(truth), replace(recording, names=base), 1)


def test_who_goes_away_while_the_base_is_hidden_is_followed(truth):
    recording = truth.recordings[0]
    t = np.arange(len(recording.positions)) / recording.rate_hz
    goes = np.column_stack([3.0 * t**2, 2.0 * t, -0.5 * t])[:, None]  # m
    seen = recording.positions + goes
    positions = seen.copy()
    base = [name.startswith("B") for name in recording.names]
    positions[20:, base] = np.nan  # until the end: nothing after it says where the base went
    solved = solve_motion(with_markers(truth), replace(recording, positions=positions), 1)
    off = solved.frames.y - predicted(solved.chain, solved.frames, solved.smoothed.q)
    assert np.nanmax(np.linalg.norm(off, axis=2)) < 0.01
    as_it_is = solve_motion(with_markers(truth), replace(recording, positions=seen), 1)
    elbow = slice(solved.marked.markers.sway + 3, None)  # the shoulder takes up how the base turns meanwhile
    away = np.degrees(np.abs(solved.smoothed.q - as_it_is.smoothed.q))[:, elbow]
    assert np.median(away) < 1.0
