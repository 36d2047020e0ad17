"""Effects that the arm file has: known in the equations, and written once."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Effect, Friction
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.given_effects import acting_arm, as_in_file, given_model
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings

EFFECTS = (
    Effect("joint_spring", {"stiffness_N_m_rad": 8.0, "rest_angle_rad": 0.3}, joints=(1,)),
    Effect("rotor_inertia", {"inertia_kg_m2": 0.1}, joints=(1,)),
    Effect("air_drag", {"drag_N_m_s2": 0.6}, joints=(1,)),
    Effect("joint_zero", {"offset_rad": 0.3}, joints=(1,)),
    Effect("gravity_tilt", {"gx_m_s2": 3.0, "gy_m_s2": 1.0}),
    Effect("actuator_delay", {"delay_s": 0.03}, joints=(1,)),
    Effect("actuator_lag", {"time_constant_s": 0.03}, joints=(1,)),
    Effect("joint_elasticity", {"stiffness_N_m_rad": 60.0, "damping_N_m_s": 0.6}, joints=(1,)),
    Effect("payload", {"mass_kg": 0.3, "trials": ["swing 2"]}),
    Effect(
        "external_push", {"start_s": 1.0, "duration_s": 0.4, "torque_N_m": 4.0, "trials": ["swing 2"]}, joints=(1,)
    ),
)
#: What the base model may take for its own: the rotor is part of the link's inertia, and so on.
ABSORBED = ("rotor_inertia", "gravity_tilt", "joint_zero")


def residual(arm, motions, *, given):
    """Return the variance that the base model leaves in units of the noise, in every trial."""
    trials = to_trials(motions, cutoff_hz=25.0)
    run = run_of(arm, trials[:2], trials[2:])
    known = given_model(arm) if given else Model()
    regression = regression_of(acting_arm(arm, run), run, given=known)
    return fitted(regression, Model(), to_all=True).squares / regression.n_effective


def moved(effect):
    """Return motions of a pendulum with an effect, and what its file says."""
    if "start_s" in effect.parameters or "trials" in effect.parameters:
        numbers = {**effect.parameters, "trials": [2]}
        if "start_s" in numbers:
            numbers["start_s"] += 3.0  # trials are simulated one after the other
        return swings((replace(effect, parameters=numbers),), trials=3), replace(pendulum(), effects=(effect,))
    return swings((effect,), trials=3), replace(pendulum(), effects=(effect,))


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda one: one.name)
def test_what_the_file_has_is_no_residual(effect):
    motions, arm = moved(effect)
    plain = residual(pendulum(), swings((), trials=3), given=True)
    known = residual(arm, motions, given=True)
    assert known.max() < 1.5 * plain.max()
    if effect.name not in ABSORBED:
        assert residual(arm, motions, given=False).max() > 2.0 * known.max()


def test_one_between_torque_and_link_gives_way_to_another():
    delay = Effect("actuator_delay", {"delay_s": 0.03}, joints=(1,))
    given = given_model(replace(pendulum(), effects=(delay, EFFECTS[0])))
    (late,) = (one for one in given.hypotheses if one.kind.name == "actuator_delay")
    assert late not in given.beside(Model((late,), (np.array([0.01]),))).hypotheses
    assert len(given.beside(Model()).hypotheses) == 2


def test_the_file_has_every_effect_once():
    late = Effect("actuator_delay", {"delay_s": 0.03}, joints=(1,))
    viscous = Effect("viscous", {"viscous_N_m_s": 0.1}, joints=(1,))
    arm = replace(pendulum(), effects=(EFFECTS[0], late, viscous, EFFECTS[4]))
    trials = to_trials(swings((), trials=2), cutoff_hz=25.0)
    run = run_of(arm, trials[:1], trials[1:])
    acting = acting_arm(arm, run)
    found = Effect("actuator_delay", {"delay_s": 0.02}, joints=(1,))
    spring = next(one for one in acting.effects if one.name == "joint_spring")
    learnt = replace(
        acting,
        joints=(replace(acting.joints[0], friction=Friction(0.7)),),
        effects=(spring, found),
    )
    written = as_in_file(arm, acting, learnt, run)
    assert written.effects == (EFFECTS[0], EFFECTS[4], found)
    assert written.gravity_m_s2 == arm.gravity_m_s2 and written.joints[0].friction.viscous_N_m_s == 0.7
