"""Rates that contradict each other."""

from dataclasses import replace

import numpy as np
import pytest

from protocol.markers.clock import clock, timed
from tests.protocol.markers.figure import walking


def test_a_rate_that_others_confirm_is_not_mentioned():
    assert clock(replace(walking(), other_rates={"the analog channels": 100.0})) == []


def test_each_contradiction_is_said():
    raw = replace(walking(), rate_hz=50.0, other_rates={"the analog channels": 100.0, "the header": 50.0})
    assert [note.text for note in clock(raw)] == [
        "the rate is 50 Hz, but 100 Hz by the analog channels",
        "the rate is 50 Hz, but 100 Hz by the column of time, which is taken for the truth",
    ]


def test_no_camera_is_so_slow():
    (note,) = clock(replace(walking(), rate_hz=12.0, t=None))
    assert note.kind == "clock" and "12 Hz" in note.text


def test_frames_at_their_times_are_left_as_they_are():
    raw = walking()
    notes, found = timed(raw)
    assert notes == [] and found is raw
    notes, found = timed(replace(raw, t=None))
    assert notes == [] and found.t is None


def test_frames_that_were_left_out_come_back_without_a_marker():
    raw = walking()
    kept = np.r_[0:300, 400:600]
    notes, found = timed(replace(raw, points=raw.points[kept], t=raw.t[kept]))
    assert [(note.kind, note.row, note.from_s, note.to_s) for note in notes] == [("clock", 301, 3.0, 4.0)]
    assert "100 frames are left out" in notes[0].text
    np.testing.assert_array_equal(found.points[kept], raw.points[kept])
    assert np.isnan(found.points[300:400]).all() and len(found.points) == 600


@pytest.mark.parametrize("rate_hz", [50.0, 99.0])
def test_the_column_of_time_overrules_the_rate(rate_hz):
    raw = walking()
    notes, found = timed(replace(raw, rate_hz=rate_hz))
    assert found.rate_hz == pytest.approx(100.0) and len(found.points) == len(raw.points)
    assert [note.kind for note in notes] == ["clock"]


def test_stamps_rounded_to_milliseconds_leave_the_rate():
    raw = walking()
    _, found = timed(replace(raw, t=np.round(np.arange(600) / 119.88, 3), rate_hz=119.88))
    assert found.rate_hz == 119.88 and len(found.points) == 600


@pytest.mark.parametrize(
    ("wrong", "said"),
    [(lambda t: t[99], "frame 101 is at 0.99 s"), (lambda t: t[99] - 0.5, "frame 101 is at 0.49 s")],
)
def test_time_that_does_not_rise_is_said(wrong, said):
    raw = walking()
    t = raw.t.copy()
    t[100] = wrong(t)
    notes, found = timed(replace(raw, t=t))
    assert [note.row for note in notes] == [101] and said in notes[0].text
    assert found.t is None and found.points is raw.points


def test_a_leap_of_time_leaves_no_hour_of_nothing():
    raw = walking()
    notes, found = timed(replace(raw, t=raw.t + 3600.0 * (np.arange(600) >= 300)))
    assert [note.row for note in notes] == [301] and "leaps by 3600 s" in notes[0].text
    assert len(found.points) == 600
