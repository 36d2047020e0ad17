"""Recordings of the daemon as something to play."""

from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm
from limbcal.errors import ConfigError, DataError, ProtocolError
from playback.recording_source import recording_source
from playback.trajectory import Trajectory
from protocol.message import FRAMES, RAW
from tests.playback.recorder import BLOCK, DT_S, START_NS, Recorder, motion


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "run.mcap"


def check(found: Trajectory, first: int, last: int) -> None:
    k = np.arange(first, last + 1)
    np.testing.assert_allclose(found.t, (k - first) * DT_S, atol=1e-12)
    for name, factor in {"q": 1, "dq": 2, "ddq": 3}.items():
        np.testing.assert_array_equal(getattr(found, name), factor * motion(k))
    assert found.method == "integrate"


def test_each_marked_motion_is_a_trial(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    for frame0 in range(1000, 2000, BLOCK):
        recorder.block(frame0)
        recorder.write(RAW, START_NS, {"sample0": 0, "t0_ns": 0, "dt_s": 1.0, "n": 1, "a": np.zeros((1, 12))})
        if frame0 == 1300:  # a rest is recognised some time after it began
            recorder.mark("begin", 1, 1105)
            recorder.mark("end", 1, 1255)
    recorder.mark("begin", 2, 1500)
    recorder.mark("end", 2, 1700)
    recorder.writer.close()
    source = recording_source(path, None)
    assert (source.name, source.arm, source.notes) == ("run.mcap", arm, ())
    assert source.durations_s == pytest.approx({1: 0.150, 2: 0.2})
    assert source.begins_s == pytest.approx(
        {1: 1e-9 * START_NS + 1.105, 2: 1e-9 * START_NS + 1.5}, abs=1e-6, rel=0
    )
    check(source.load(1), 1105, 1255)
    check(source.load(2), 1500, 1700)


def test_lost_frames_are_bridged_and_marked(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    recorder.block(0)
    recorder.block(30, gap=True)
    recorder.block(40, gap=True)
    recorder.mark("begin", 1, 0)
    recorder.mark("end", 1, 49)
    recorder.writer.close()
    found = recording_source(path, None).load()
    np.testing.assert_allclose(np.diff(found.t), [1e-3] * 9 + [21e-3] + [1e-3] * 19)
    assert found.lost is not None
    assert np.flatnonzero(found.lost).tolist() == [10, 20]


def test_a_recording_without_marks_is_one_trial(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    for frame0 in range(0, 100, BLOCK):
        recorder.block(frame0)
    recorder.writer.close()
    source = recording_source(path, None)
    check(source.load(1), 0, 99)
    (note,) = source.notes
    assert note.kind == "trials" and "no motion is marked" in note.text


def test_a_recording_cut_by_a_kill_is_played_as_far_as_it_goes(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    recorder.mark("begin", 1, 20)
    for frame0 in range(0, 200, BLOCK):
        recorder.block(frame0)
        recorder.writer._writer.flush()  # a chunk a block
        if frame0 == 100:
            reached = recorder.writer.size_bytes
    recorder.writer.close()
    path.write_bytes(path.read_bytes()[: reached + 50])
    source = recording_source(path, None)
    check(source.load(1), 20, 109)
    assert [note.kind for note in source.notes] == ["damaged"] and "cut" in source.notes[0].text


def test_a_trial_without_frames_is_left_out_and_said(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    recorder.block(0)
    recorder.mark("begin", 1, 0)
    recorder.mark("end", 1, 9)
    recorder.mark("begin", 2, 500)
    recorder.writer.close()
    source = recording_source(path, None)
    assert source.trials == (1,)
    assert f"{path}: trial 2 is left out" in source.notes[0].sentence


def test_another_arm_can_be_put_in_place_of_the_recorded_one(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    recorder.block(0)
    recorder.writer.close()
    vertical = load_arm("dd-arm-vertical")
    assert recording_source(path, vertical).arm == vertical


@pytest.mark.parametrize(
    ("write", "error", "said"),
    [
        (lambda r: None, DataError, "holds no limb/frames"),
        (lambda r: r.block(0, q=np.zeros((10, 3))), ProtocolError, "no usable field q, dq, ddq"),
        (lambda r: r.write(FRAMES, 0, {"q": np.zeros((1, 2))}), ProtocolError, "no usable field 'dt_s'"),
        (lambda r: [r.block(0), r.mark("begin", 1, 0), r.mark("begin", 1, 5)], DataError, "begins twice"),
        (lambda r: [r.block(0), r.mark("begin", 1, 100)], DataError, "frames of no trial"),
        (lambda r: [r.block(0), r.block(0)], DataError, "trial 1: t goes from 0.009 to 0 s"),
        (
            lambda r: [r.block(k, **dict.fromkeys(("q", "dq", "ddq"), np.zeros((10, 3)))) for k in (0, 10)],
            ConfigError,
            "moves 3 joint",
        ),
    ],
)
def test_a_recording_that_cannot_be_played_is_refused_in_one_sentence(
    path: Path, arm: Arm, write, error: type[Exception], said: str
) -> None:
    recorder = Recorder(path, arm)
    write(recorder)
    recorder.writer.close()
    with pytest.raises(error, match=said) as caught:
        recording_source(path, None)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_no_recording_is_refused(path: Path) -> None:
    with pytest.raises(DataError, match="cannot be read"):
        recording_source(path, None)
    path.write_bytes(b"t,q1\n0,0\n")
    with pytest.raises(ProtocolError, match="expected an MCAP"):
        recording_source(path, None)


def test_a_rate_that_was_found_meanwhile_is_followed(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    for frame0, dt_s in ((0, 0.001), (10, 0.001), (20, 0.00104), (30, 0.00104)):
        recorder.block(frame0, dt_s=dt_s)
    recorder.writer.close()
    found = recording_source(path, None).load(1)
    np.testing.assert_allclose(np.diff(found.t), [0.001] * 20 + [0.00104] * 19, atol=1e-12)


@pytest.mark.parametrize(("second", "lost"), [(10, []), (11, [10]), (12, [10])])
def test_frames_whose_numbers_leap_were_lost(path: Path, arm: Arm, second: int, lost: list[int]) -> None:
    recorder = Recorder(path, arm)
    recorder.block(0)
    recorder.block(second)
    recorder.writer.close()
    found = recording_source(path, None).load(1).lost
    assert found is not None and np.flatnonzero(found).tolist() == lost


@pytest.mark.parametrize(("end", "trials"), [(24, (1,)), (25, (1, 2)), (26, (1, 2))])
def test_two_frames_are_a_trial(path: Path, arm: Arm, end: int, trials: tuple[int, ...]) -> None:
    recorder = Recorder(path, arm)
    for frame0 in range(0, 50, BLOCK):
        recorder.block(frame0)
    recorder.mark("end", 3, 5)  # of one that began before the recording
    recorder.mark("begin", 1, 0)
    recorder.mark("end", 1, 9)
    recorder.mark("begin", 2, 24)
    recorder.mark("end", 2, end)
    recorder.writer.close()
    source = recording_source(path, None)
    assert source.trials == trials
    if 2 in trials:
        check(source.load(2), 24, end)


def test_frames_of_other_joints_do_not_follow(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    recorder.block(0)
    recorder.block(10, **dict.fromkeys(("q", "dq", "ddq"), np.zeros((10, 3))))
    recorder.writer.close()
    with pytest.raises(ProtocolError, match="frames of 2 joints are followed by frames of 3, expected no change"):
        recording_source(path, None)


def test_an_empty_block_changes_nothing(path: Path, arm: Arm) -> None:
    recorder = Recorder(path, arm)
    recorder.block(7, 0, dt_s=9.0)
    recorder.block(0)
    recorder.block(10, 0, dt_s=9.0)
    recorder.block(10)
    recorder.writer.close()
    assert recording_source(path, None).load(1).duration_s > 0.0
