"""What a calibration took for granted."""

from dataclasses import replace

import pytest

from arm.arm_file import load_arm
from arm.model import Control
from fitter.report.assumptions import dynamics_assumptions, kinematics_assumptions


@pytest.fixture(scope="module")
def arm():
    return load_arm("dd-arm")


def test_the_law_and_its_gains_are_named_with_what_they_scale(arm):
    said = " ".join(dynamics_assumptions(arm, lengths_learnt=True, targets_found=True))
    assert "eq. (5)" in said and "kp = 9.5, 9.5; kv = -9.5, -9.5" in said and "ka" not in said
    assert "scales with these gains" in said and "targets were not recorded" in said
    assert "Gravity is (0, 0, -9.80665) m/s²" in said
    position = replace(arm, control=Control("p", kp=(5.5, 4.0)))
    said = " ".join(dynamics_assumptions(position, lengths_learnt=False, targets_found=False))
    assert "eq. (7)" in said and "kp = 5.5, 4" in said and "kv" not in said and "targets" not in said
    assert "Lengths are taken from the arm file (a1 = 0.2500 m, a2 = 0.3000 m)" in said


def test_a_measured_torque_scales_everything(arm):
    weightless = replace(arm, control=Control(), gravity_m_s2=(0.0, 0.0, 0.0))
    said = " ".join(dynamics_assumptions(weightless, lengths_learnt=False, targets_found=False))
    assert "Torque was measured" in said and "gains" not in said and "no gravity" in said


def test_sensors_and_joints_are_those_of_the_arm_file(arm):
    said = " ".join(kinematics_assumptions(arm))
    assert "1 turns, 2 turns" in said and "s1 on link 1 at (0.100, 0, 0) m" in said
    assert "Lengths scale" not in " ".join(kinematics_assumptions(replace(arm, sensors=())))


def test_where_nothing_drove_no_torque_is_said_to_have_been_measured():
    said = " ".join(
        dynamics_assumptions(load_arm("dd-arm"), lengths_learnt=False, targets_found=False, driven=False)
    )
    assert "nothing drove the joints" in said
    assert "Torque was measured" not in said
