"""Rates that contradict each other."""

from dataclasses import replace

from protocol.markers.clock import clock
from tests.protocol.markers.figure import walking


def test_a_rate_that_others_confirm_is_not_mentioned():
    assert clock(replace(walking(), other_rates={"the analog channels": 100.0})) == []


def test_each_contradiction_is_said():
    raw = replace(walking(), rate_hz=50.0, other_rates={"the analog channels": 100.0, "the header": 50.0})
    assert [note.text for note in clock(raw)] == [
        "the rate is 50 Hz, but 100 Hz by the analog channels",
        "the rate is 50 Hz, but 100 Hz by the column of time",
    ]


def test_no_camera_is_so_slow():
    (note,) = clock(replace(walking(), rate_hz=12.0, t=None))
    assert note.kind == "clock" and "12 Hz" in note.text
