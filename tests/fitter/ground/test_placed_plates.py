"""Plates are found to be under the ends of a tree that stand on them."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import axis_frames
from fitter.data.base_columns import base_state
from fitter.ground.link_names import segments
from fitter.ground.placed_plates import ends, placed
from protocol.markers.wrench_files import PlateWrench

PERSON = load_arm("human-body")
T = np.arange(20) / 10.0
Q = np.tile(0.1 * np.random.default_rng(0).normal(size=PERSON.n_joint), (len(T), 1))


def under(segment: str, force_N: float = 400.0) -> PlateWrench:
    """Return a plate that is loaded for half of the time, 5 cm from a segment's joint."""
    at = axis_frames(PERSON, Q)[:, segments(PERSON)[segment], :3, 3] + [0.03, -0.04, 0.0]
    force = np.where(T[:, None] < 1.0, force_N, 0.0) * np.array([0.0, 0.0, 1.0])
    return PlateWrench(segment, T, force, at, np.zeros((len(T), 3)))


@pytest.mark.parametrize("segment", ["foot_right", "foot_left", "hand_right"])
def test_a_loaded_plate_is_under_the_end_nearest_to_it(segment):
    plates = [under(segment), under("foot_left", 0.0)]
    base = base_state(PERSON, T, None, "motion.csv")
    assert placed(PERSON, T, Q, base, plates) == [(plates[0], segments(PERSON)[segment] + 1)]


def test_ends_of_a_person_are_feet_and_hands_and_of_a_chain_the_last():
    feet_and_hands = {
        segments(PERSON)[f"{what}_{side}"] for what in ("foot", "hand") for side in ("right", "left")
    }
    assert {*ends(PERSON)} == feet_and_hands
    assert ends(load_arm("human-arm-right")) == [8]
