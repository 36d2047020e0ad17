"""Rows of errors: torque of every joint, unfiltered where it was measured, and simulated angles in degrees."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.diagnosis.held_out_error import Errors
from fitter.report.diagnosis_errors import BY_NAME, by_name_rows, error_rows


@pytest.fixture
def errors():
    """Return errors of one trial of two joints: torques of 3 and 4 N m, angles of 1 degree."""
    one_degree = np.radians(1.0)
    return Errors(
        np.array([[9.0, 16.0]]),
        np.ones((1, 2)),
        np.zeros(1, dtype=np.intp),
        np.array([[36.0, 49.0]]),
        np.full((1, 2), one_degree**2),
        np.full((1, 2), one_degree),
        np.full((1, 2), one_degree),
        np.ones((1, 2)),
        np.array([True, True]),
        [np.zeros((1, 2))],
    )


def test_every_joint_has_its_torque_and_angles_are_in_degrees(errors):
    rows = error_rows(load_arm("dd-arm-vertical"), [errors, errors])
    assert [row[1:] for row in rows[:4]] == [("3", "3"), ("4", "4"), ("6", "6"), ("7", "7")]
    assert [float(row[1]) for row in rows[4:]] == [1.0, 1.0, 1.0]


def test_where_no_torque_was_measured_none_is_unfiltered(errors):
    rows = error_rows(load_arm("dd-arm-vertical"), [errors, replace(errors, unfiltered_square=None)])
    assert not any("unfiltered" in row[0] for row in rows)


def test_a_joint_that_slides_has_its_position(errors):
    slides = replace(errors, turns=np.array([True, False]))
    rows = error_rows(load_arm("dd-arm-vertical"), [slides])
    assert [row[0] for row in rows[-3:]] == [f"position, {name} [m]" for name in ("mean", "rms", "max")]
    assert float(rows[-1][1]) == pytest.approx(np.radians(1.0), rel=1e-2)


def test_a_set_has_a_cell_a_column(errors):
    (row,) = by_name_rows({"monday": (errors, errors)})
    assert row[:3] == ("monday", "3, 4", "3, 4")
    assert len(row) == 1 + len(BY_NAME)
