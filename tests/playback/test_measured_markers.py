"""Measured markers beside a motion: in frame 0, on the motion's clock, and absent where they were not seen."""

from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm
from limbcal.errors import ConfigError, DataError
from playback.measured_markers import MeasuredMarkers, read_measured_markers
from tests.playback.tracked_markers import ARM, BEGIN_S, N_FRAME, RATE_HZ, trc, written


def test_markers_come_in_frame_0_whatever_carries_it(tmp_path: Path) -> None:
    files = written(tmp_path, off_m=(0.01, 0.0, -0.02))
    found, _ = read_measured_markers(files.motion, [files.recording], ARM)
    assert list(found) == [1]
    assert found[1].t[0] == 0.0
    for own, there in zip(found[1].places[5:15], files.places[5:15], strict=True):
        np.testing.assert_allclose(own, there, atol=1e-8)


def test_a_marker_that_was_not_seen_is_nowhere(tmp_path: Path) -> None:
    files = written(tmp_path)
    found, notes = read_measured_markers(files.motion, [files.recording], ARM)
    assert np.isnan(found[1].places[21:29, 1]).all()
    assert np.isfinite(found[1].places[:, 0]).all()
    assert [(note.kind, note.columns) for note in notes if note.kind == "gap"] == [("gap", ("knee",))]


def test_between_two_samples_it_is_on_the_line_between_them() -> None:
    track = MeasuredMarkers(np.array([0.0, 1.0, 3.0]), np.array([[[0.0, 0, 0]], [[2.0, 0, 0]], [[np.nan, 0, 0]]]))
    assert track.at(0.25)[0, 0] == pytest.approx(0.5)
    assert track.at(1.0)[0, 0] == pytest.approx(2.0)
    assert np.isnan(track.at(1.5)[0, 0])
    assert track.at(-1.0)[0, 0] == 0.0


@pytest.mark.parametrize(
    ("names", "begin_s", "says"),
    [(("a", "b", "c"), BEGIN_S, "it has no marker of arm"), (("hip", "knee", "toe"), 90.0, "begins at 2 s")],
)
def test_a_recording_of_another_motion_is_refused(
    tmp_path: Path, names: tuple[str, ...], begin_s: float, says: str
) -> None:
    files = written(tmp_path)
    other = tmp_path / "other.trc"
    t = begin_s + np.arange(N_FRAME) / RATE_HZ
    other.write_text(trc(t, np.random.default_rng(1).normal(size=(N_FRAME, 3, 3)), names), encoding="utf-8")
    with pytest.raises(DataError, match=says):
        read_measured_markers(files.motion, [other], ARM)


def test_every_trial_has_its_recording(tmp_path: Path) -> None:
    files = written(tmp_path)
    with pytest.raises(ConfigError, match="names 2 recordings, expected one for each of the 1 trial of"):
        read_measured_markers(files.motion, [files.recording] * 2, ARM)


def test_an_arm_without_markers_is_refused(tmp_path: Path) -> None:
    files = written(tmp_path)
    with pytest.raises(ConfigError, match=r"has no \[\[marker\]\]"):
        read_measured_markers(files.motion, [files.recording], load_arm("dd-arm"))
