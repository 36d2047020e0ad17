"""Gaps, and what stands in their place."""

from dataclasses import replace

import numpy as np
import pytest

from protocol.markers.missing import ended, gaps, zeros
from tests.protocol.markers.figure import RATE_HZ, walking


def test_gaps_of_a_tenth_of_a_second_on_are_said_with_their_times():
    raw = walking()
    raw.points[100:109, 0] = np.nan
    raw.points[200:250, 1] = np.nan
    raw.points[:, 2] = np.nan
    notes = gaps(raw.labels, raw.points, RATE_HZ)
    assert [(note.columns, note.from_s, note.to_s) for note in notes] == [
        (("head2",), 2.0, 2.5),
        (("head3",), None, None),
    ]


def test_a_file_that_ends_before_its_header_says_is_said():
    raw = walking()
    assert ended(raw) == ended(replace(raw, stated_frames=len(raw.points))) == []
    (note,) = ended(replace(raw, stated_frames=700))
    assert (note.kind, note.from_s, note.to_s) == ("gap", 6.0, 7.0)
    assert "says 700 frames and it holds 600" in note.text


@pytest.mark.parametrize("stored", [0.0, -16512.0])
def test_what_is_stored_for_a_gap_is_taken_for_one(stored):
    raw = walking()
    raw.points[300:, 4] = stored
    notes, points = zeros(raw.labels, raw.points, RATE_HZ)
    assert [(note.kind, note.columns, note.from_s, note.to_s) for note in notes] == [
        ("zeros", ("trunk1",), 3.0, 6.0)
    ]
    assert np.isnan(points[300:, 4]).all() and np.isfinite(points[:300]).all()
