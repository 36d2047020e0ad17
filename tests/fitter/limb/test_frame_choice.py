"""Frames of a fit: which are usable, how they are thinned, and that skin's errors count once a coherence time."""

import numpy as np
import pytest

from fitter.limb.frame_choice import COHERENCE_S, left_out, shares, thinned, usable_frames
from limbcal.errors import NotIdentifiable
from protocol.markers.recording import MarkerRecording


def observed(n=40, n_marker=5):
    return np.zeros((n, n_marker, 3)), np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3))


def recording(n=40, rate_hz=100.0, path="one.trc"):
    return MarkerRecording(path, rate_hz, (), np.zeros((n, 0, 3)), "m", "+z")


def test_a_frame_needs_a_pose_of_the_base_and_three_markers():
    y, R, p = observed()
    y[3, :3] = np.nan
    y[4, :2] = np.nan
    p[7] = np.nan
    frames, usable = usable_frames(y, R, p, [recording()])
    assert np.flatnonzero(~usable).tolist() == [3, 7]
    assert len(frames.t) == 38
    with pytest.raises(NotIdentifiable, match="one.trc: no frame shows the base"):
        usable_frames(np.full_like(y, np.nan), R, p, [recording()])


def test_thinned_frames_are_usable_and_evenly_spread():
    usable = np.ones(1000, dtype=np.bool_)
    usable[::7] = False
    chosen = thinned(usable, 50)
    assert usable[chosen].all() and len(np.unique(chosen)) == 50
    assert np.ptp(np.diff(chosen)) <= 3
    assert thinned(usable, 10_000).tolist() == np.flatnonzero(usable).tolist()


@pytest.mark.parametrize("rate_hz", [50.0, 100.0, 400.0])
def test_a_trial_counts_as_its_duration_over_the_coherence_time_whatever_the_rate(rate_hz):
    t = np.arange(round(3.0 * rate_hz)) / rate_hz
    y, R, p = observed(len(t))
    total = shares(usable_frames(y, R, p, [recording(len(t), rate_hz)])[0]).sum()
    assert total == pytest.approx(3.0 / COHERENCE_S, rel=1e-9)


def test_frames_further_apart_than_the_coherence_time_count_fully():
    y, R, p = observed(6)
    assert shares(usable_frames(y, R, p, [recording(6, 1.0)])[0]).tolist() == [1.0] * 6


def test_a_recording_without_a_usable_frame_is_said():
    recordings = [recording(5, path=f"of/{k}.trc") for k in range(3)]
    usable = np.ones(15, dtype=np.bool_)
    usable[9] = False
    assert left_out(usable, recordings) == ()
    usable[5:10] = False
    (note,) = left_out(usable, recordings)
    assert note.kind == "left_out" and note.text.startswith("1.trc: no frame shows the base")
