"""Joints that are held by static friction."""

from arm.model import Effect
from fitter.diagnosis.search import StaticFriction
from fitter.diagnosis.static_friction import sticking
from fitter.search.fitted_parameter import FittedParameter
from tests.fitter.pendulum import pendulum


def test_an_arm_whose_joints_stick_has_it_as_an_effect_each():
    arm = pendulum()
    assert sticking(arm, []) is arm
    held = StaticFriction(0, FittedParameter(0.7, 0.1, "N m", True), 0.5)
    assert sticking(arm, [held]).effects == (Effect("stiction", {"static_N_m": 0.7}, joints=(1,)),)
