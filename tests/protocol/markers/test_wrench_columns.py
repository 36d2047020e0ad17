"""The names that laboratories give to a plate's force, point and moment."""

from pathlib import Path

import pytest

from limbcal.errors import DataError
from protocol.markers.wrench_columns import plate_columns

FILE = Path("forces.mot")


def named(*forms):
    """Return the columns of a form for each axis, after that of time."""
    return ["time", *(form.replace("#", axis) for form in forms for axis in "xyz")]


@pytest.mark.parametrize(
    ("force", "point", "moment", "name"),
    [
        ("ground_force_v#", "ground_force_p#", "ground_torque_#", "ground_force"),
        ("ground_force_1_v#", "ground_force_1_p#", "ground_moment_1_m#", "ground_force_1"),
        ("ground_force1_v#", "ground_force1_p#", "ground_moment1_m#", "ground_force1"),
        ("1_ground_force_v#", "1_ground_force_p#", "1_ground_torque_#", "1_ground_force"),
        ("ground_force_r_v#", "ground_force_r_p#", "ground_torque_r_#", "ground_force_r"),
        ("ground_force_left_v#", "ground_force_left_p#", "ground_moment_left_m#", "ground_force_left"),
        ("R_ground_force_v#", "R_ground_force_p#", "R_ground_torque_#", "R_ground_force"),
        ("F#1", "COP#1", "M#1", "1"),
        ("Fp1_F#", "Fp1_COP_#", "Fp1_T#", "Fp1"),
        ("Force.F#1", "COP.#1", "Moment.M#1", "Force.1"),
        ("calcn_r_GRF_F#", "calcn_r_GRF_p#", "calcn_r_GRF_T#", "calcn_r_GRF"),
        ("GRF_#_left", "COP_#_left", "GRM_#_left", "left"),
    ],
)
def test_a_plate_is_put_together_of_its_columns(force, point, moment, name):
    (plate,) = plate_columns(named(force, point, moment), FILE)
    assert plate.name == name
    for k, of in enumerate((plate.force, plate.point, plate.moment)):
        assert of == {axis: 1 + 3 * k + i for i, axis in enumerate("xyz")}


def test_plates_are_told_apart_by_their_names():
    names = named("ground_force_r_v#", "ground_force_l_v#", "ground_torque_l_#", "ground_torque_r_#")
    right, left = plate_columns(names, FILE)
    assert (right.name, left.name) == ("ground_force_r", "ground_force_l")
    assert (right.moment["x"], left.moment["x"]) == (10, 7)


@pytest.mark.parametrize(
    ("names", "wrong"),
    [
        (named("Force.F#1"), "plate 'Force.1' has a force but neither a point nor a moment"),
        (named("a_v#", "a_p#", "b_torque_#"), "column 'b_torque_x' is of no plate with a force"),
        (named("a_v#", "a_p#", "COP1#"), "column 'COP1x' is of no plate with a force"),
        (named("a_v#", "a_p#", "b_m#"), "column 'b_mx' is of no plate with a force"),
        (named("a_v#", "a_p#", "a_v#"), "columns 'a_vx' and 'a_vx' are both x of one plate's force"),
        (["time", "a_vy", "a_px", "a_py", "a_pz"], "force of plate 'a' has a_vy and no column for x and z"),
        ([*named("a_v#"), "a_px", "a_pz"], "point of plate 'a' has a_px, a_pz and no column for y"),
        ([*named("a_v#"), "a_mz"], "moment of plate 'a' has a_mz and no column for x and y"),
    ],
)
def test_a_plate_that_is_not_whole_is_refused(names, wrong):
    with pytest.raises(DataError, match=f"forces.mot: .*{wrong}"):
        plate_columns(names, FILE)


def test_other_columns_are_passed_over():
    names = named("pelvis_t#", "a_v#", "a_p#")
    (plate,) = plate_columns([*names, "hip_flexion_r", "max_speed", "hip_flexion_r_moment"], FILE)
    assert plate.name == "a" and not plate.moment
