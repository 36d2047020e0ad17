"""Runs of frames, and what a recording says of its time."""

from dataclasses import replace

import numpy as np
import pytest

from protocol.markers.recording import MarkerRecording, RawRecording, runs


def test_runs_begin_and_end_where_a_mask_does():
    assert runs(np.array([1, 1, 0, 1, 0, 0, 1], dtype=bool)) == [(0, 2), (3, 4), (6, 7)]
    assert runs(np.zeros(3, dtype=bool)) == []


def test_time_begins_at_the_first_frame_and_a_marker_is_missing_where_it_is_nan():
    positions = np.zeros((5, 2, 3))
    positions[1:3, 1] = np.nan
    recording = MarkerRecording("a.trc", 50.0, ("a", "b"), positions, "m", "+z")
    np.testing.assert_allclose(recording.t, [0.0, 0.02, 0.04, 0.06, 0.08])
    np.testing.assert_array_equal(recording.missing.sum(axis=0), [0, 2])


def test_the_first_frames_time_follows_from_the_first_that_has_one():
    t = np.array([np.nan, np.nan, 5.2, 5.3, 5.5])  # the last stamps are late
    raw = RawRecording("a.trc", 10.0, "m", ("a",), np.zeros((5, 1, 3)), t)
    assert raw.t0_s == pytest.approx(5.0)
    assert replace(raw, t=None).t0_s == replace(raw, t=np.full(5, np.nan)).t0_s == 0.0
