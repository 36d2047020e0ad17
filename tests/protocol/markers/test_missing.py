"""Gaps, and what stands in their place."""

import numpy as np
import pytest

from protocol.markers.missing import gaps, zeros
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


@pytest.mark.parametrize("stored", [0.0, -16512.0])
def test_what_is_stored_for_a_gap_is_taken_for_one(stored):
    raw = walking()
    raw.points[300:, 4] = stored
    notes, points = zeros(raw.labels, raw.points, RATE_HZ)
    assert [(note.kind, note.columns, note.from_s, note.to_s) for note in notes] == [
        ("zeros", ("trunk1",), 3.0, 6.0)
    ]
    assert np.isnan(points[300:, 4]).all() and np.isfinite(points[:300]).all()
