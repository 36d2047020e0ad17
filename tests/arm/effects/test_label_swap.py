"""Two markers that have each other's names."""

from dataclasses import replace

import pytest

from arm.arm_file import load_arm
from arm.effects.marker_effects import marked_in
from arm.model import Effect, Marker

SWAPPED = Effect("label_swap", {}, markers=("A", "B"))


@pytest.fixture
def arm():
    markers = (Marker("A", 1, (0.1, 0.0, 0.0), 0.004), Marker("C", 1), Marker("B", 2, (0.2, 0.0, 0.0)))
    return replace(load_arm("dd-arm"), markers=markers)


def test_exchanged_names_stay_at_their_places(arm):
    a, c, b = marked_in(replace(arm, effects=(SWAPPED,)), 1).markers
    assert (a, c, b) == (replace(arm.markers[0], name="B"), arm.markers[1], replace(arm.markers[2], name="A"))


def test_twice_is_as_if_never(arm):
    assert marked_in(replace(arm, effects=(SWAPPED, SWAPPED)), 1).markers == arm.markers


def test_it_may_be_in_some_trials_alone(arm):
    having = replace(arm, effects=(replace(SWAPPED, parameters={"trials": [2]}),))
    assert marked_in(having, 1).markers == arm.markers != marked_in(having, 2).markers


def test_it_takes_two_markers_and_trials_from_the_first(accepts, arm):
    assert accepts("label_swap") and accepts("label_swap", trials=[1, 1_000_000])
    assert not accepts("label_swap", trials=[0]) and not accepts("label_swap", trials=[1_000_001])
    assert not accepts("label_swap", trials=1)
