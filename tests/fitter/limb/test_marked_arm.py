"""An arm with markers taken apart: which ride on links, which on the base, and what cannot be tracked."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_pose import base_in_segment
from arm.model import Marker
from benchmarks.simulated_people.person import person, with_markers
from fitter.limb.marked_arm import marked_arm
from limbcal.errors import ConfigError


def test_markers_of_links_come_first_and_those_of_the_base_in_its_segment():
    arm = with_markers(person(n=60))
    marked = marked_arm(arm)
    on_links = [m.name for m in arm.markers if m.joint]
    carried = [m for m in arm.markers if not m.joint]
    assert marked.names == (*on_links, *(m.name for m in carried))
    R, p = base_in_segment(arm)
    for name, place in zip(marked.base.markers, marked.base.points_m, strict=True):
        (own,) = [m for m in carried if m.name == name]
        np.testing.assert_allclose(place, R @ own.position_m + p)


def test_a_marker_wanders_as_the_file_says_but_no_less_than_four_millimetres():
    arm = with_markers(person(n=60))
    first, *others = [m for m in arm.markers if m.joint]
    for stated, taken in ((0.02, 0.02), (0.001, 0.004), (None, 0.008)):
        marked = marked_arm(replace(arm, markers=(replace(first, std_m=stated), *others)))
        assert marked.markers.std[0] == pytest.approx(taken)


def test_an_arm_without_markers_cannot_be_tracked():
    with pytest.raises(ConfigError, match=r"no \[\[marker\]\]"):
        marked_arm(person(n=60).arm)


def test_a_joint_that_slides_cannot_be_tracked():
    first, second = load_arm("dd-arm").joints
    arm = replace(load_arm("dd-arm"), joints=(first, replace(second, type="prismatic")))
    with pytest.raises(ConfigError, match="has a joint that slides"):
        marked_arm(replace(arm, markers=(Marker("hand", 2, (0.1, 0.0, 0.0)),)))
