"""Motions that reveal."""

from fitter.functional.advice import motion_for_axis, motion_for_centre


def test_a_joint_of_either_side_has_its_motion():
    assert motion_for_centre("hip_left") == motion_for_centre("hip_right") != motion_for_centre("shoulder_left")
    assert "palm" in motion_for_axis("forearm_right")


def test_a_joint_of_another_name_has_a_motion_too():
    assert "two planes" in motion_for_centre("joint")
    assert "axis alone" in motion_for_axis("joint_4_right")
