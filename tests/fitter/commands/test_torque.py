"""`fitter torque`: on which link a plate's force acts."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.commands.torque import contacts_of
from limbcal.errors import ConfigError
from protocol.markers.wrench_files import PlateWrench


def plate(name: str, force_N: float = 400.0) -> PlateWrench:
    zero = np.zeros((2, 3))
    return PlateWrench(name, np.array([0.0, 1.0]), zero + [0.0, force_N, 0.0], zero, zero)


def test_a_whole_persons_feet_are_links_by_their_names():
    left, right = plate("left"), plate("right")
    found = contacts_of(["1=foot_left", "right=foot_right"], [left, right], load_arm("human-body"))
    assert [one for one, _ in found] == [left, right]
    assert [joint for _, joint in found] == [21, 15]


def test_of_a_robot_links_are_numbers():
    assert contacts_of(["1=2"], [plate("table")], load_arm("dd-arm"))[0][1] == 2
    assert contacts_of([], [plate("table"), plate("empty", 0.0)], load_arm("dd-arm"))[0][1] == 2


@pytest.mark.parametrize("text", ["1=3", "1=0", "1=foot_left", "1", "7=1"])
def test_a_link_or_plate_that_is_not_there_is_said(text):
    with pytest.raises(ConfigError, match="--contact"):
        contacts_of([text], [plate("table")], load_arm("dd-arm"))


def test_two_loaded_plates_need_a_word():
    with pytest.raises(ConfigError, match="such as --contact 'a'=hand_left"):
        contacts_of([], [plate("a"), plate("b")], load_arm("human-body"))
