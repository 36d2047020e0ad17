"""Joint-motion files as something to play."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.model import Arm
from limbcal.errors import ConfigError, DataError
from playback.file_source import file_source
from playback.player import Player
from playback.source import Source


def test_a_file_plays_what_it_holds(motion_file: Path, source: Source, arm: Arm) -> None:
    found = file_source(motion_file, arm)
    assert found.trials == source.trials
    assert found.name == "waves.npz"
    for trial in source.trials:
        known, motion = source.load(trial), found.load(trial)
        assert found.durations_s[trial] == source.durations_s[trial]
        for name in ("t", "q", "dq", "ddq"):
            np.testing.assert_array_equal(getattr(motion, name), getattr(known, name))


def test_missing_derivatives_are_taken_without_a_shift_in_time(tmp_path: Path, arm: Arm) -> None:
    t = np.linspace(0.0, 1.0, 201)
    path = tmp_path / "parabola.npz"
    np.savez(path, t=t + 3.0, q1=t**2, q2=-(t**2))
    motion = file_source(path, arm).load()
    np.testing.assert_allclose(motion.dq, np.column_stack([2 * t, -2 * t]), atol=1e-12)
    np.testing.assert_allclose(motion.ddq, np.tile([2.0, -2.0], (201, 1)), atol=1e-9)


def test_three_rows_show_how_the_speed_changes(tmp_path: Path, arm: Arm) -> None:
    path = tmp_path / "three.csv"
    path.write_text("t,q1,q2\n0,0,0\n1,1,2\n2,4,8\n", encoding="utf-8")  # t^2 and 2 t^2
    np.testing.assert_allclose(file_source(path, arm).load().dq, [[0.0, 0.0], [2.0, 4.0], [4.0, 8.0]])


def test_a_frame_says_that_rows_are_missing_before_it(tmp_path: Path, arm: Arm, fake_time) -> None:
    t = np.delete(np.arange(100) * 0.01, range(41, 60))
    np.savez(tmp_path / "hole.npz", t=t, q1=t, q2=t)
    player = Player(file_source(tmp_path / "hole.npz", arm), 100.0, fake_time.clocks)
    player.play()
    fake_time.now_s += 1.0
    gaps = [frame["position_s"] for frame in iter(player.take_due, None) if frame["gap"]]
    np.testing.assert_allclose(gaps, np.arange(41, 61) * 0.01)


def test_two_rows_are_a_motion(tmp_path: Path, arm: Arm) -> None:
    path = tmp_path / "two.csv"
    path.write_text("t,q1,q2\n0,0,0\n0.5,1,2\n", encoding="utf-8")
    np.testing.assert_array_equal(file_source(path, arm).load().dq, [[2.0, 4.0], [2.0, 4.0]])


@settings(deadline=None)
@given(turns=st.floats(-3.0, 3.0), start=st.floats(-np.pi, np.pi))
def test_angles_that_were_written_modulo_a_turn_go_on(arm: Arm, turns: float, start: float) -> None:
    """What lies between two samples is the short way."""
    t = np.linspace(0.0, 1.0, 101)
    whole = start + 2.0 * np.pi * turns * t
    wrapped = np.angle(np.exp(1j * whole))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "turning.npz"
        np.savez(path, t=t, q1=wrapped, q2=0.1 * t)
        found = file_source(path, arm)
        motion = found.load()
    between = motion.at(t[:-1] + 0.005)[0]
    np.testing.assert_allclose(np.diff(between[:, 0]), 2.0 * np.pi * turns * 0.01, atol=1e-9)
    np.testing.assert_allclose(between[:, 1], 0.1 * (t[:-1] + 0.005), atol=1e-12)
    of_turns = [note for note in found.notes if note.kind != "unit"]  # an arm that hardly moves: degrees?
    assert bool(of_turns) == bool(np.any(np.abs(np.diff(wrapped)) > np.pi))


def test_what_slides_is_not_unwrapped(tmp_path: Path, arm: Arm) -> None:
    sliding = replace(arm, joints=(arm.joints[0], replace(arm.joints[1], type="prismatic")))
    path = tmp_path / "slide.npz"
    np.savez(path, t=np.arange(3.0), q1=np.zeros(3), q2=np.array([0.0, 4.0, 0.0]))
    assert file_source(path, sliding).load().q[:, 1].tolist() == [0.0, 4.0, 0.0]


def test_what_does_not_fit_is_refused(tmp_path: Path, arm: Arm, motion_file: Path) -> None:
    path = tmp_path / "one.csv"
    path.write_text("t,q1\n0,0\n0.5,1\n", encoding="utf-8")
    with pytest.raises(DataError, match="no column 'q2' beside q1 among its columns t, q1"):
        file_source(path, arm)
    path.write_text("t,q1,q2\n0,0,0\n0,1,1\n", encoding="utf-8")
    with pytest.raises(DataError, match="in row 2 time stands still at 0 s"):
        file_source(path, arm)
    with pytest.raises(ConfigError, match="waves.npz: there is no trial 4, expected one of 1, 2, 3"):
        file_source(motion_file, arm).load(4)


@pytest.mark.parametrize(("rounding", "written_modulo"), [(0.0, True), (1e-6, True), (2e-6, False)])
def test_angles_lie_in_a_turn_give_or_take_a_millionth(
    tmp_path: Path, arm: Arm, rounding: float, written_modulo: bool
) -> None:
    turn = 2.0 * np.pi * (1.0 + rounding)
    path = tmp_path / "leap.npz"
    np.savez(path, t=np.arange(3.0), q1=np.array([0.0, turn, turn]), q2=np.zeros(3))
    found = file_source(path, arm)
    expected = turn - 2.0 * np.pi if written_modulo else turn
    assert found.load().q[1, 0] == pytest.approx(expected, abs=1e-12)
    assert bool(found.notes) == written_modulo
