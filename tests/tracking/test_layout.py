"""Which sensors tell which joint."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Arm, Joint, Sensor
from limbcal.errors import ConfigError
from tracking.layout import layout_of


def test_two_sensors_of_a_link_give_its_angle(dd_arm):
    layout = layout_of(dd_arm)
    assert layout.pair.tolist() == [[0, 1], [2, 3]] and layout.link.tolist() == [0, 0, 1, 1]
    np.testing.assert_array_equal(layout.rotation, [np.eye(3)] * 4)


def test_of_several_the_two_furthest_apart_across_the_axis_are_taken():
    places = [(0.1, 0.0, 0.9), (0.3, 0.0, 0.0), (0.2, 0.0, -0.9), (0.1, 0.1, 0.0)]
    arm = Arm("one", (Joint(),), sensors=tuple(Sensor(f"s{k}", 1, at) for k, at in enumerate(places)))
    assert layout_of(arm).pair.tolist() == [[1, 3]]


def test_order_in_the_file_does_not_matter(dd_arm):
    mixed = replace(dd_arm, sensors=tuple(dd_arm.sensors[k] for k in (3, 0, 2, 1)))
    assert layout_of(mixed).pair.tolist() == [[1, 3], [0, 2]]


def test_a_joint_that_slides_needs_one(sliding):
    assert layout_of(sliding).pair.tolist() == [[0, 1], [2, 2]]


def test_every_link_that_cannot_be_tracked_is_named():
    along_the_axis = (Sensor("s1", 1, (0.1, 0.0, 0.0)), Sensor("s2", 1, (0.1, 0.0, 0.3)))
    arm = Arm("three", (Joint(), Joint("prismatic"), Joint()), sensors=along_the_axis)
    with pytest.raises(ConfigError) as caught:
        layout_of(arm)
    assert caught.value.mistakes == [
        "arm 'three': joint 1 turns and has 2 sensors on its link; expected two that lie apart across its axis",
        "arm 'three': joint 2 slides and has no sensor on its link, expected one",
        "arm 'three': joint 3 turns and has 0 sensors on its link; expected two that lie apart across its axis",
    ]
