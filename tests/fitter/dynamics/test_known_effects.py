"""An arm's effects are known: masses are learnt from what they leave, and they belong to the arm again."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Effect
from arm.regressor import standard_parameters
from fitter.dynamics.evaluation import explained_torque, score
from fitter.dynamics.fit import fit_dynamics
from fitter.dynamics.known_effects import taken_out_notes, without_effects
from limbcal.errors import ConfigError
from tests.fitter.dynamics.test_torque_wiring import ARM, driven

EFFECTS = (
    Effect("joint_spring", {"stiffness_N_m_rad": 5.0, "rest_angle_rad": 0.2}, (2,)),
    Effect("rotor_inertia", {"inertia_kg_m2": 0.1}, (2,)),
    Effect("gravity_tilt", {"gx_m_s2": 1.0, "gy_m_s2": -0.5}, ()),
    Effect("joint_zero", {"offset_rad": 0.3}, (2,)),
    Effect("air_drag", {"drag_N_m_s2": 0.4}, (2,)),
    Effect("periodic_disturbance", {"amplitude_N_m": 2.0, "frequency_hz": 0.4, "phase_rad": 0.3}, (1,)),
    Effect("payload", {"mass_kg": 0.5, "trials": [2]}, ()),
    Effect("load_friction", {"coefficient": 0.2}, (2,)),
)


def with_effect(effect):
    """Return the arm with an effect, and two motions with the torque that it takes, the second one later."""
    arm, trials = replace(ARM, effects=(effect,)), []
    for number in (1, 2):
        trial = replace(driven(ARM, number), number=number, began_s=10.0 * (number - 1))
        tau = trial.tau
        for _ in range(30 if effect.name == "load_friction" else 1):  # which depends on the torque itself
            tau = explained_torque(arm, trial, tau)
        trials.append(replace(trial, tau=tau, tau_measured=None, whole={}))
    return arm, trials


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_masses_are_learnt_beside_it(effect):
    arm, trials = with_effect(effect)
    fit = fit_dynamics(arm, trials, objective="torque", method="least-squares", examine=False)
    assert fit.arm.effects == arm.effects and fit.arm.gravity_m_s2 == arm.gravity_m_s2
    assert [joint.theta_offset_rad for joint in fit.arm.joints] == [0.0, 0.0]
    own = score(fit.arm, trials)
    assert min(own.explained) > 1.0 - 1e-6
    true = fit.base.combination @ standard_parameters(ARM)
    assert [fit.parameters[name].value for name in fit.base.names] == pytest.approx(true, rel=1e-4, abs=1e-5)


def test_an_arm_without_effects_is_left_alone():
    trial = driven(ARM, 1)
    arm, trials = without_effects(ARM, [trial])
    assert arm is ARM and trials[0] is trial and taken_out_notes(ARM, arm) == []


def test_what_was_taken_out_is_said():
    bias = Effect("sensor_bias", {"x_m_s2": 0.1, "y_m_s2": 0.0, "z_m_s2": 0.0}, (), ("s1",))
    arm = replace(ARM, effects=(*EFFECTS[:2], bias))
    (note,) = taken_out_notes(arm, without_effects(arm, ())[0])
    assert "joint_spring, rotor_inertia" in note.text and "sensor_bias" not in note.text


@pytest.mark.parametrize(
    "effect",
    [
        Effect("actuator_lag", {"time_constant_s": 0.01}, (1,)),
        Effect("joint_elasticity", {"stiffness_N_m_rad": 100.0, "damping_N_m_s": 0.1}, (2,)),
    ],
)
def test_what_lies_between_torque_and_joint_is_refused(effect):
    with pytest.raises(ConfigError, match=effect.name):
        without_effects(replace(ARM, effects=(effect,)), [driven(ARM, 1)])


def test_under_a_law_the_motion_alone_is_fitted_with_them():
    law = replace(ARM, control=replace(ARM.control, law="pd", kp=(9.5, 9.5), kv=(-9.5, -9.5)), effects=EFFECTS[:1])
    trial = driven(ARM, 1)
    with pytest.raises(ConfigError, match="a law drives"):
        without_effects(law, [trial], "torque")
    assert without_effects(law, [trial], "motion")[1] == [trial]


def test_a_sensors_effect_is_no_part_of_the_torque():
    arm = replace(
        ARM, effects=(Effect("sensor_bias", {"x_m_s2": 0.1, "y_m_s2": 0.0, "z_m_s2": 0.0}, (), ("s1",)),)
    )
    assert without_effects(arm, [driven(ARM, 1)])[0] is arm
    assert np.isfinite(driven(ARM, 1).tau).all()
