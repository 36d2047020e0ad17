"""A run in several files, from any of them on."""

from pathlib import Path

import numpy as np
import pytest

from arm.model import Arm
from playback.recording_source import recording_source
from protocol.recording_files import numbered
from tests.playback.recorder import DT_S, Recorder, motion


@pytest.fixture
def run(tmp_path: Path, arm: Arm) -> Path:
    """Write a run in two files: trial 1 goes from one to the other, trial 2 is in the second."""
    path = tmp_path / "dd-arm-20260101T000000Z-abcdef12.mcap"
    first = Recorder(path, arm, "one")
    first.blocks(0, 200)
    first.mark("begin", 1, 100)
    first.writer.close()
    second = Recorder(numbered(path, 2), arm, "one")
    second.mark("begin", 1, 100)  # what may not have reached the disk is in both
    second.blocks(180, 300)
    second.mark("end", 1, 250)
    second.mark("begin", 2, 260)
    second.mark("end", 2, 290)
    second.writer.close()
    return path


def test_a_trial_goes_on_in_the_next_file(run: Path) -> None:
    source = recording_source(run, None)
    assert not source.notes
    assert source.durations_s == pytest.approx({1: 0.150, 2: 0.030})
    found = source.load(1)
    np.testing.assert_allclose(found.t, np.arange(151) * DT_S, atol=1e-12)
    np.testing.assert_array_equal(found.q, motion(np.arange(100, 251)))
    assert found.lost is not None and not found.lost.any()


def test_what_began_before_the_file_named_is_said(tmp_path: Path, arm: Arm) -> None:
    path = tmp_path / "arm-abcdef12.mcap"
    Recorder(path, arm, "one").writer.close()
    second = Recorder(numbered(path, 2), arm, "one")
    second.blocks(200, 300)
    second.mark("end", 1, 250)
    second.mark("begin", 2, 260)
    second.writer.close()
    source = recording_source(numbered(path, 2), None)
    assert source.trials == (2,)
    assert [note.text for note in source.notes] == ["trial 1 is left out, since it began before this file"]


def test_where_no_motion_begins_all_is_played_and_said(tmp_path: Path, arm: Arm) -> None:
    recorder = Recorder(tmp_path / "tail.mcap", arm)
    recorder.blocks(0, 100)
    recorder.mark("end", 1, 50)
    recorder.writer.close()
    source = recording_source(tmp_path / "tail.mcap", None)
    assert source.durations_s[1] == pytest.approx(0.099)
    assert "no motion begins in it, so all of it is played as trial 1" in source.notes[-1].text


def test_files_that_are_not_there_or_not_of_the_run_are_said(run: Path, arm: Arm) -> None:
    numbered(run, 2).rename(numbered(run, 4))
    other = Recorder(numbered(run, 5), arm, "another")
    other.blocks(0, 100)
    other.writer.close()
    numbered(run, 6).write_bytes(b"t,q1\n0,0\n")
    source = recording_source(run, None)
    assert source.trials == (1, 2)
    lost, other_run, no_recording = source.notes
    assert lost.text == f"2 file(s) between {run.name} and {numbered(run, 4).name} are not there: not played"
    assert other_run.source == str(numbered(run, 5)) and "it is of another run" in other_run.text
    assert no_recording.kind == "unused" and no_recording.text.endswith("it is not played")
