"""Base parameters of an arm's structure."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.structural_parameters import structural, structural_parameters

ARM = load_arm("dd-arm")


@pytest.mark.parametrize("off_rad", [0.001, -0.017])
def test_an_axis_a_degree_off_adds_no_parameter(off_rad):
    joints = (ARM.joints[0], replace(ARM.joints[1], alpha_rad=ARM.joints[1].alpha_rad + off_rad))
    bent = replace(ARM, joints=joints)
    assert structural(bent) == structural(ARM)
    assert structural_parameters(bent).names == base_parameters(ARM).names


def test_a_straight_arm_s_parameters_are_its_own():
    own = base_parameters(ARM)
    assert structural_parameters(ARM).names == own.names
    assert np.array_equal(structural_parameters(ARM).combination, own.combination)


def test_an_axis_two_degrees_off_is_meant_so():
    joints = (ARM.joints[0], replace(ARM.joints[1], alpha_rad=np.deg2rad(2.0)))
    assert structural(replace(ARM, joints=joints)).joints[1].alpha_rad == pytest.approx(np.deg2rad(2.0))
