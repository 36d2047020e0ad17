"""The torque of an arm's effects along a motion."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.effect_table import changed
from arm.effects.payload import with_load
from arm.effects.resisting_torque import resisting_torque
from arm.model import Effect
from arm.moving_base import BaseState, standing_base
from arm.newton_euler import inverse_dynamics
from limbcal.errors import ConfigError, DataError


@pytest.fixture
def moved(arm):
    q, dq, ddq, u = np.random.default_rng(0).normal(size=(4, 6, 3))
    return q, dq, ddq, u, np.arange(6) * 0.1


def test_the_torque_beyond_the_rigid_arm(arm, having, swung):
    loaded = having(having(arm, "payload", mass_kg=0.7, since_s=0.4), "rotor_inertia", joint=2, inertia_kg_m2=0.2)
    loaded = having(loaded, "joint_zero", joint=2, offset_rad=0.3)
    motion = swung(loaded)
    wanted = inverse_dynamics(changed(loaded), motion.q, motion.dq, motion.ddq)
    wanted += resisting_torque(loaded, motion.q, motion.dq, motion.ddq, motion.tau, motion.t)
    moving = np.all(motion.dq != 0.0, axis=1)
    np.testing.assert_allclose(wanted[moving], motion.tau[moving], rtol=0, atol=1e-9)


def test_effects_add_up_in_their_own_joints(arm, moved):
    on = (
        Effect("viscous", {"viscous_N_m_s": 0.2}, (1, 3)),
        Effect("viscous", {"viscous_N_m_s": 0.3}, (3,)),
        Effect("load_friction", {"coefficient": 0.1}, (2,)),
        Effect("rotor_inertia", {"inertia_kg_m2": 0.4}, (2,)),
        Effect("periodic_disturbance", {"amplitude_N_m": 0.5, "frequency_hz": 1.0, "phase_rad": 0.0}, (1,)),
        Effect("thermal_drift", {"rate_1_s": 0.1}, (3,)),
    )
    _, dq, ddq, u, t = moved
    expected = np.column_stack(
        [
            0.2 * dq[:, 0] - 0.5 * np.sin(2.0 * np.pi * t),
            0.1 * np.abs(u[:, 1]) * np.sign(dq[:, 1]) + 0.4 * ddq[:, 1],
            0.5 * dq[:, 2] + 0.1 * t * (0.3 * dq[:, 2] + 0.2 * np.sign(dq[:, 2])),
        ]
    )
    np.testing.assert_allclose(resisting_torque(replace(arm, effects=on), *moved), expected, rtol=0, atol=1e-12)


def test_a_resting_joint_resists_where_it_would_go(arm, having):
    rubbing, still, t = having(arm, "coulomb", joint=2, coulomb_N_m=0.5), np.zeros((1, 3)), np.zeros(1)
    ahead = resisting_torque(rubbing, still, still, still, still, t, direction=np.ones((1, 3)))
    assert ahead.tolist() == [[0.0, 0.5, 0.0]]
    assert not resisting_torque(rubbing, still, still, still, still, t).any()


def test_a_payload_counts_in_its_trials_and_from_its_time(arm, having, moved):
    q, dq, ddq, _, _ = moved
    load = inverse_dynamics(with_load(arm, 0.7), q, dq, ddq) - inverse_dynamics(arm, q, dq, ddq)
    later = having(arm, "payload", mass_kg=0.7, since_s=0.3, trials=[2])
    assert not resisting_torque(later, *moved).any()
    found = resisting_torque(later, *moved, trial=2)
    np.testing.assert_allclose(found[3:], load[3:], rtol=0, atol=1e-12)
    assert not found[:3].any() and np.abs(load).max() > 1.0


def test_a_base_that_rises_makes_the_payload_heavier(arm, having, moved):
    """Upward acceleration is felt as that much more gravity."""
    loaded, standing = having(arm, "payload", mass_kg=0.7), standing_base(6)
    still = resisting_torque(loaded, *moved)
    np.testing.assert_allclose(resisting_torque(loaded, *moved, base=standing), still, rtol=0, atol=1e-10)
    up = np.tile([0.5, 0.0, 2.0], (6, 1))
    rising = BaseState(standing.R, standing.p, standing.omega, standing.omega_dot, up)
    x, y, z = arm.gravity_m_s2
    heavy = replace(loaded, gravity_m_s2=(x - 0.5, y, z - 2.0))
    found = resisting_torque(loaded, *moved, base=rising)
    np.testing.assert_allclose(found, resisting_torque(heavy, *moved), rtol=0, atol=1e-10)
    assert np.abs(found - still).max() > 0.1


def test_what_does_not_fit_is_named(arm, having, moved):
    with pytest.raises(DataError, match=r"t has shape \(3,\), expected \(6,\)"):
        resisting_torque(arm, *moved[:4], moved[4][:3])
    with pytest.raises(DataError, match="u has 5 samples and q has 6"):
        resisting_torque(arm, *moved[:3], moved[3][:5], moved[4])
    with pytest.raises(ConfigError, match="factor is -1.0, expected a number from 0 to 100"):
        resisting_torque(having(arm, "gain_error", factor=-1.0), *moved)
