"""A marker that sits elsewhere on its link than was said."""

from dataclasses import replace

import numpy as np

from arm.arm_file import load_arm
from arm.effects.marker_effects import marked_in
from arm.effects.marker_moved import EFFECT
from arm.model import Effect, Marker

MOVED = {"x_m": 0.01, "y_m": 0.03, "z_m": -0.02}
MARKERS = (Marker("A", 1, (0.1, 0.0, 0.5), 0.004), Marker("B", 2, (0.2, 0.0, 0.0)))
ARM = replace(load_arm("dd-arm"), markers=MARKERS)


def test_its_own_marker_is_moved_along_the_links_axes():
    moved, other = marked_in(replace(ARM, effects=(Effect("marker_moved", MOVED, markers=("A",)),)), 1).markers
    np.testing.assert_allclose(moved.position_m, [0.11, 0.03, 0.48])
    assert replace(moved, position_m=MARKERS[0].position_m) == MARKERS[0] and other == MARKERS[1]


def test_moved_there_and_back_it_is_where_it_was():
    back = {name: -value for name, value in MOVED.items()}
    both = tuple(Effect("marker_moved", numbers, markers=("A", "B")) for numbers in (MOVED, back))
    for found, was in zip(marked_in(replace(ARM, effects=both), 1).markers, MARKERS, strict=True):
        np.testing.assert_allclose(found.position_m, was.position_m, atol=1e-15)


def test_with_its_neutral_numbers_it_stays():
    neutral = {p.name: p.neutral for p in EFFECT.parameters if not p.optional}
    assert (
        marked_in(replace(ARM, effects=(Effect("marker_moved", neutral, markers=("A",)),)), 1).markers == MARKERS
    )


def test_what_it_may_be(ranges, accepts):
    for axis in MOVED:
        ranges("marker_moved", axis, -1.0, 1.0, **{name: 0.0 for name in MOVED if name != axis})
    assert accepts("marker_moved", **MOVED, trials=[1, 1_000_000])
    assert not accepts("marker_moved", **MOVED, trials=[0])
    assert not accepts("marker_moved", **MOVED, trials=[1_000_001])
