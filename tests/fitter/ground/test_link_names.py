"""Links by the segments that they carry."""

from dataclasses import replace

import pytest

from arm.arm_file import load_arm
from arm.body.whole_body import body_map
from benchmarks.simulated_people.ground import PERSON
from fitter.ground.link_names import link_named, link_names, segments
from limbcal.errors import ConfigError

LEG = load_arm("human-leg-right")


def test_segments_of_a_person_and_of_a_leg_have_their_names():
    names = link_names(PERSON)
    assert names[body_map().parts["foot_left"].link] == "foot_left" and names[0] == "link 1"
    assert len(names) == PERSON.n_joint and len(set(names)) == len(names)
    assert segments(LEG) == {"thigh_right": 2, "shank_right": 3, "foot_right": 5}
    assert link_names(LEG) == ["link 1", "link 2", "thigh_right", "shank_right", "link 5", "foot_right"]


def test_another_arm_has_numbers():
    other = replace(LEG, name="rig")
    assert segments(other) == {} and link_names(other) == [f"link {i}" for i in range(1, 7)]


@pytest.mark.parametrize(
    ("text", "found"),
    [("1=foot_right", ("1", 5)), ("plate a = 3", ("plate a", 2)), ("1=1", ("1", 0)), ("1=6", ("1", 5))],
)
def test_a_contact_is_a_plate_and_a_link(text, found):
    assert link_named(text, LEG) == found


@pytest.mark.parametrize("text", ["1=0", "1=7", "=2", "1=foot_left", "1", "1=-1"])
def test_what_names_no_link_is_refused(text):
    with pytest.raises(ConfigError, match="expected PLATE=LINK, a link being 1 to 6, thigh_right"):
        link_named(text, LEG)
