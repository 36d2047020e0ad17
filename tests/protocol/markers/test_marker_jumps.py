"""Leaps are found, and no movement is one."""

import numpy as np

from protocol.markers.marker_jumps import jumps
from tests.protocol.markers.figure import RATE_HZ, walking


def test_a_marker_that_leaps_away_and_back_is_said_once():
    raw = walking()
    none = np.zeros(raw.points.shape[:2], dtype=bool)
    assert jumps(raw.labels, raw.points, RATE_HZ, none) == []
    raw.points[150:200, 3] += [0.1, 0.0, 0.05]
    (note,) = jumps(raw.labels, raw.points, RATE_HZ, none)
    assert (note.kind, note.columns, note.from_s, note.to_s) == ("jump", ("head4",), 1.5, 2.0)


def test_leaps_with_another_cause_are_not_repeated():
    raw = walking()
    raw.points[150:, 3] += 0.2
    known = np.zeros(raw.points.shape[:2], dtype=bool)
    known[150:, 3] = True
    assert jumps(raw.labels, raw.points, RATE_HZ, known) == []
    for frame in range(145, 156):  # the two frames before the leap and the two after it are of it
        one = np.zeros_like(known)
        one[frame, 3] = True
        assert bool(jumps(raw.labels, raw.points, RATE_HZ, one)) == (frame not in range(148, 152))


def test_a_leap_of_thirty_millimetres_is_one():
    for size_m, count in ((0.028, 0), (0.032, 1)):
        raw = walking()
        none = np.zeros(raw.points.shape[:2], dtype=bool)
        raw.points[150:, 3] = raw.points[149, 3]
        raw.points[:150, 3] = raw.points[149, 3]
        raw.points[150:, 3] += [size_m, 0.0, 0.0]
        assert len(jumps(raw.labels, raw.points, RATE_HZ, none)) == count
