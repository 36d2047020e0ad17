"""Which sensors tell which joint."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.model import Arm, Joint, Sensor
from limbcal.errors import ConfigError
from tracking.model.sensor_layout import layout_of


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


@pytest.mark.parametrize(("apart_m", "enough"), [(0.9e-3, False), (1.0e-3, True), (1.1e-3, True)])
def test_a_millimetre_apart_is_enough(apart_m, enough):
    sensors = (Sensor("s1", 1, (0.0, 0.0, 0.0)), Sensor("s2", 1, (0.0, apart_m, 0.5)))
    arm = Arm("one", (Joint(),), sensors=sensors)
    if enough:
        assert layout_of(arm).pair.tolist() == [[0, 1]]
    else:
        with pytest.raises(ConfigError, match="expected two that lie apart across its axis"):
            layout_of(arm)


def test_places_and_turns_are_the_sensors_own(sliding):
    layout = layout_of(sliding)
    assert layout.link.tolist() == [0, 0, 1]
    np.testing.assert_array_equal(layout.position[2], [0.02, 0.01, 0.1])
    turn = Rotation.from_euler("xyz", [0.2, -0.4, 0.6]).as_matrix()
    np.testing.assert_allclose(layout.rotation[1], turn, atol=1e-12)


def test_a_tree_is_not_for_dead_reckoning(branching):
    with pytest.raises(ConfigError, match="'branching' is a tree.* expects a serial chain, the filter"):
        layout_of(branching)
