"""An arm's numbers moved by its simulated motion."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Effect, Friction
from fitter.diagnosis.simulated_motion.polish import polish
from fitter.dynamics.structure import structural_parameters
from limbcal.errors import ConfigError

ROTOR = "effect[0].inertia_kg_m2"


def test_what_was_wrong_is_found_and_kept(wrong_arm, trials):
    found = polish(wrong_arm, trials[:1], trials[1:], ["I2", "fc2", ROTOR], 0.5, std={"fc2": 0.01})
    assert found.kept and found.converged
    assert found.values[ROTOR] == pytest.approx(0.004, rel=0.1)
    assert found.values["fc2"] == pytest.approx(0.02, rel=0.1)
    assert abs(found.values[ROTOR] - 0.004) < 5.0 * found.std[ROTOR]
    assert found.arm.effects[0].parameters["inertia_kg_m2"] == found.values[ROTOR]
    assert found.arm.joints[1].friction.coulomb_N_m == pytest.approx(found.values["fc2"])
    for before, after in (found.learn, found.evaluate):
        assert after.motion.total_rms < 0.3 * before.motion.total_rms
        assert after.torque_rms[1] < before.torque_rms[1]


def test_what_makes_evaluating_trials_worse_is_not_kept(true_arm, wrong_arm, trials):
    heavy = replace(
        trials[0], tau=2.0 * trials[0].tau, whole=trials[0].whole | {"tau": 2.0 * trials[0].whole["tau"]}
    )
    found = polish(true_arm, [heavy], trials[1:], ["I2", "fc2"], 0.5)
    assert not found.kept and found.arm == true_arm and found.found != true_arm
    assert found.evaluate[1].motion.total_mean > found.evaluate[0].motion.total_mean


def test_a_close_prior_holds_numbers_where_they_were(wrong_arm, trials):
    std = {"fc2": 1e-5}
    held = polish(wrong_arm, trials[:1], trials[1:], ["fc2"], 0.5, std, prior_factor=1.0)
    free = polish(wrong_arm, trials[:1], trials[1:], ["fc2"], 0.5, std)
    assert abs(held.values["fc2"] - 0.03) < 0.2 * abs(free.values["fc2"] - 0.03)


def test_friction_brakes_in_sum_at_every_speed_that_was_seen(true_arm, trials):
    driving = replace(
        true_arm,
        joints=(true_arm.joints[0], replace(true_arm.joints[1], friction=Friction(0.0, -0.02))),
        effects=(Effect("viscous", {"viscous_N_m_s": 0.005}, joints=(2,)),),
    )
    found = polish(driving, trials[:1], trials[1:], ["fc2", "effect[0].viscous_N_m_s"], 0.5)
    speed = np.abs(trials[0].dq[:, 1])
    seen = np.array([speed[speed > 0.0].min(), speed.max()])
    assert np.all(found.values["fc2"] + found.values["effect[0].viscous_N_m_s"] * seen >= -1e-9)


def test_the_catalogues_bounds_are_kept(true_arm, trials):
    base = structural_parameters(true_arm)
    lighter = replace(true_arm, effects=(Effect("quadratic_drag", {"drag_N_m_s2": 1e-3}, joints=(2,)),))
    found = polish(lighter, trials[:1], trials[1:], [base.names[-1], "effect[0].drag_N_m_s2"], 0.5)
    assert found.values["effect[0].drag_N_m_s2"] >= 0.0


def test_an_unknown_number_is_named(true_arm, trials):
    with pytest.raises(ConfigError, match="nothing is called mass"):
        polish(true_arm, trials[:1], trials[1:], ["mass"], 0.5)
