"""Labels exchanged at a leap are exchanged again; other recordings decide which part has the right ones."""

from dataclasses import replace

import numpy as np
import pytest

from protocol.markers.crossings import uncrossed
from protocol.markers.marker_files import look_at
from protocol.markers.recording import MarkerRecording
from tests.protocol.markers.figure import RATE_HZ, walking

#: Two of one segment, of which the third marker is as far from either, and the last two are not.
SITS = np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.0, 0.12, 0.0], [0.09, -0.05, 0.15], [0.07, 0.05, 0.12]])


def a_thigh_and_shank(seed=0):
    """Return a thigh's five markers, and three of a shank that hardly moves against it and shows nothing."""
    raw = walking(seed=seed)
    rng = np.random.default_rng(seed)
    t = np.arange(len(raw.points)) / RATE_HZ
    turn = 0.4 * np.sin(2.0 * np.pi * 0.4 * t)
    c, s, o = np.cos(turn), np.sin(turn), np.zeros_like(turn)
    axes = np.stack([np.stack([c, o, s], 1), np.stack([o, o + 1, o], 1), np.stack([-s, o, c], 1)], 1)
    slide = 0.004 * np.sin(2.0 * np.pi * 0.4 * t)[:, None] * [0.0, 0.0, 1.0]  # of skin, by the motion
    places = [np.einsum("tab,b->ta", axes, at) + slide * (k > 1) for k, at in enumerate(SITS)]
    places += [np.einsum("tab,b->ta", axes, at + [0.0, 0.0, -0.4]) for at in SITS[[2, 2, 2]] * [[1], [-1], [0.2]]]
    points = np.stack(places, axis=1) + 5e-4 * rng.normal(size=(len(t), len(places), 3))
    labels = tuple(f"T{k}" for k in range(5)) + tuple(f"S{k}" for k in range(3))
    return replace(raw, labels=labels, points=points + [0.0, 0.0, 1.0])


def with_each_others_labels(raw, first, last):
    points = raw.points.copy()
    points[first:last, [0, 1]] = points[first:last, [1, 0]]
    return replace(raw, points=points)


def test_an_exchange_of_half_a_recording_is_put_right():
    sound = a_thigh_and_shank()
    looked = look_at([with_each_others_labels(sound, 260, 600), a_thigh_and_shank(1)])[0]
    (note,) = [one for one in looked.notes if one.kind == "swapped"]
    assert set(note.columns) == {"T0", "T1"} and (note.from_s, note.to_s) == pytest.approx((2.6, 6.0))
    np.testing.assert_array_equal(looked.recording.positions, sound.points)
    assert not [one for one in looked.notes if one.kind == "jump"]


def test_segments_that_stand_elsewhere_in_another_recording_have_no_say():
    sound, other = a_thigh_and_shank(), a_thigh_and_shank(1)
    far = np.linspace(0.3, 0.9, 12)[:, None] * [1.0, 0.4, 0.2]  # of a trunk that leans another way there

    def with_trunk(raw, turn):
        trunk = np.broadcast_to(1.0 + far * turn, (len(raw.points), 12, 3))
        labels = (*raw.labels, *(f"B{k}" for k in range(12)))
        return replace(raw, labels=labels, points=np.concatenate([raw.points, trunk], axis=1))

    looked = look_at(
        [with_each_others_labels(with_trunk(sound, 1.0), 260, 600), with_trunk(other, [-1.0, 1.0, 2.0])]
    )
    (note,) = [one for one in looked[0].notes if one.kind == "swapped"]
    assert (note.from_s, note.to_s) == pytest.approx((2.6, 6.0))


def test_alone_the_longer_part_is_taken_for_right():
    sound = a_thigh_and_shank()
    looked = look_at([with_each_others_labels(sound, 0, 260)])[0]
    (note,) = [one for one in looked.notes if one.kind == "swapped"]
    assert (note.from_s, note.to_s) == pytest.approx((0.0, 2.6)) and "no other recording" in note.text
    np.testing.assert_array_equal(looked.recording.positions, sound.points)


def seen_in_the_exchange_only():
    """Return a thigh whose second marker appears at the first one's place, and is lost where that leaps there."""
    damaged = with_each_others_labels(a_thigh_and_shank(), 200, 260)
    damaged.points[120:200, 1] = damaged.points[260:330, 1] = np.nan
    return damaged


def test_one_marker_leaps_onto_the_place_of_another_that_is_lost_or_found_there():
    damaged, expected = seen_in_the_exchange_only(), a_thigh_and_shank().points
    looked = look_at([damaged])[0]
    (note,) = [one for one in looked.notes if one.kind == "swapped"]
    assert set(note.columns) == {"T0", "T1"} and (note.from_s, note.to_s) == pytest.approx((2.0, 2.6))
    expected[120:200, 1] = expected[260:330, 1] = np.nan
    np.testing.assert_array_equal(looked.recording.positions, expected)


def test_a_glimpse_between_two_leaps_is_an_exchange():
    sound = a_thigh_and_shank()
    damaged = with_each_others_labels(sound, 300, 302)
    damaged.points[250:300, 1] = damaged.points[302:340, 1] = np.nan  # seen in the exchange only
    looked = look_at([damaged])[0]
    (note,) = [one for one in looked.notes if one.kind == "swapped"]
    assert (note.from_s, note.to_s) == pytest.approx((3.0, 3.02))
    np.testing.assert_array_equal(looked.recording.positions[300:302], sound.points[300:302])


def test_after_one_marker_leapt_runs_that_do_not_end_there_are_left_alone():
    """Where other segments have moved, their distances look like those of an exchange."""
    damaged = seen_in_the_exchange_only()
    damaged.points[400:410] = np.nan
    damaged.points[410:420, [0, 1]] = damaged.points[410:420, [1, 0]]
    damaged.points[420:430] = np.nan
    raw = MarkerRecording(damaged.path, RATE_HZ, damaged.labels, damaged.points, "m", "+z")
    notes, _, where = uncrossed(raw, [])
    assert [(note.from_s, note.to_s) for note in notes] == [pytest.approx((2.0, 2.6))]
    assert not where[400:].any()


def test_none_is_claimed_where_none_leaps():
    raw = walking()
    one = MarkerRecording(raw.path, RATE_HZ, raw.labels, raw.points, "m", "+z")
    notes, positions, where = uncrossed(one, [])
    assert notes == [] and not where.any()
    np.testing.assert_array_equal(positions, one.positions)
