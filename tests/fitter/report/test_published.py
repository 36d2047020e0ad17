"""The paper's figures stand beside parameters that there are."""

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
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
