"""The paper's figures stand beside parameters that there are."""

import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.regressor import standard_parameters
from fitter.kinematics.tip_basis import geometry_names
from fitter.report import published


def test_every_figure_is_of_a_parameter_of_its_arm():
    arm = load_arm(published.ARM)
    assert set(published.KINEMATICS) <= set(geometry_names(arm.n_joint))
    assert tuple(published.DYNAMICS) == base_parameters(arm).names
    assert {role: max_deg > mean_deg for role, (mean_deg, max_deg) in published.ANGLE_ERROR_DEG.items()} == {
        "learn": True,
        "evaluate": True,
    }


def test_the_papers_rows_are_whole():
    assert len(published.TABLE1) == 13
    assert {len(row) for row in published.TABLE1} == {10}
    rows = [*published.TABLE3.values(), *published.TABLE4.values(), *published.TABLE5.values()]
    rows += [*published.TABLE6.values(), published.TRUE]
    assert {len(row) for row in rows} == {len(published.PARAMETERS)}
    # Table 4's first row and Table 6's third are the same calibration
    assert published.TABLE4[9.5, -9.5] == published.TABLE6[300_000]


def test_the_geometry_is_in_the_units_of_a_fit():
    assert published.KINEMATICS["a1"] == 0.245785
    assert published.KINEMATICS["beta2"] == pytest.approx(-0.003617 * 3.14159265 / 180.0)


def test_the_true_values_are_those_of_the_arm():
    arm = load_arm(published.ARM)
    base = base_parameters(arm)
    assert base.combination @ standard_parameters(arm) == pytest.approx(published.TRUE, abs=5e-7)
