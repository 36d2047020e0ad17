"""What labels say."""

from dataclasses import replace

import numpy as np

from protocol.markers.labels import computed, doubled, names_of, prefixes
from tests.protocol.markers.figure import walking


def test_prefixes_are_said_once_and_left_out():
    raw = walking()
    assert prefixes(raw) == []
    (note,) = prefixes(replace(raw, labels=tuple(f"Anna:{label}" for label in raw.labels)))
    assert note.kind == "prefix" and note.columns == raw.labels and "Anna" not in note.text


def test_what_programs_compute_is_no_marker():
    raw = replace(walking(), labels=("LKneeAngles", "force", *walking().labels[2:]), computed=frozenset({"force"}))
    (note,), is_one = computed(raw)
    assert note.columns == ("LKneeAngles", "force")
    assert is_one == [True, True] + [False] * 18


def test_markers_of_one_name_or_at_one_place_are_said():
    raw = walking()
    assert doubled(raw.labels, raw.points) == []
    points = np.concatenate([raw.points, raw.points[:, :2]], axis=1)
    notes = doubled((*raw.labels, "Head.1", "copy"), points)
    assert [note.columns for note in notes] == [("head1", "Head.1"), ("head2", "copy")]


def test_a_prefix_that_alone_tells_two_markers_apart_stays():
    assert names_of(("A:one", "A:two", "B:two")) == ("one", "A:two", "B:two")
