"""Exchanged labels are found by distances and exchanged again; none is claimed where none is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from protocol.markers.recording import MarkerRecording
from protocol.markers.swaps import _bridged, agreed, put_right
from tests.protocol.markers.figure import RATE_HZ, walking


def recording(seed=0):
    raw = walking(seed=seed)
    return MarkerRecording(raw.path, RATE_HZ, raw.labels, raw.points, "m", "+z")


def exchanged(one, i, j, first, last):
    positions = one.positions.copy()
    positions[first:last, [i, j]] = positions[first:last, [j, i]]
    return replace(one, positions=positions)


def told_apart(one, i, j):
    """Say whether the distances of two markers to others of their segments differ: by twice what skin moves."""
    median = np.median(np.linalg.norm(one.positions[:, :, None] - one.positions[:, None], axis=3), axis=0)
    segment = [name.rstrip("0123456789") for name in one.names]
    others = ([k for k in range(len(segment)) if segment[k] == segment[of] and k not in (i, j)] for of in (i, j))
    return all(np.median(np.abs(median[i, some] - median[j, some])) > 0.03 for some in others)


@settings(max_examples=20, deadline=None)
@example(0, 2, 1, 84)  # what it does to the distances of two others looks like an exchange of these
@example(16, 19, 16, 43)  # in the last two frames they are hardly wrong
@example(9, 11, 1, 10)  # of four on a segment the other two are the mirror image
@given(st.integers(0, 19), st.integers(0, 19), st.integers(1, 400), st.integers(10, 180))
def test_any_two_labels_exchanged_for_a_while_are_put_right(i, j, first, lasts):
    one = recording()
    assume(i == j or told_apart(one, i, j))
    notes, positions, where = put_right(exchanged(one, i, j, first, first + lasts), {})
    if i == j:
        assert notes == [] and not where.any()
        return
    (note,) = notes
    assert set(note.columns) == {one.names[i], one.names[j]}
    assert (note.from_s, note.to_s) == pytest.approx((first / RATE_HZ, (first + lasts) / RATE_HZ), abs=0.02)
    np.testing.assert_allclose(positions, one.positions, atol=0.03)


def test_no_exchange_is_claimed_where_none_is():
    one = recording()
    notes, positions, where = put_right(one, agreed([recording(seed) for seed in range(3)]))
    assert notes == [] and not where.any()
    np.testing.assert_array_equal(positions, one.positions)


def test_labels_exchanged_throughout_are_told_by_other_recordings():
    clean = [recording(seed) for seed in range(3)]
    wrong = exchanged(clean[0], 2, 9, 0, len(clean[0].positions))
    assert put_right(wrong, {})[0] == []
    (note,), positions, _ = put_right(wrong, agreed([wrong, *clean[1:]]))
    assert set(note.columns) == {"head3", "thigh2"} and note.from_s is None
    np.testing.assert_array_equal(positions, clean[0].positions)


def test_two_recordings_that_differ_tell_not_which_is_wrong():
    assert agreed([recording(0), recording(1)]) == {}


def test_an_exchange_goes_on_where_its_markers_were_not_seen():
    mask, missing = np.zeros((2, 30), dtype=np.bool_)
    mask[[*range(3, 8), *range(12, 16), *range(20, 24)]] = True
    missing[8:12] = missing[26:] = True
    expected = mask.copy()
    expected[8:12] = True  # seen, and as they should be, from 16 to 20
    np.testing.assert_array_equal(_bridged(mask, missing), expected)
