"""An arm's effects as arrays: what acts where, with which numbers, and whether it has a direction."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.effect_table import changed, effect_table, no_effects
from arm.effects.joint_numbers import DAMPING, DELAY, FACTOR, GAP, LAG, LIMIT, ROTOR, STIFFNESS
from arm.effects.joint_torque import torque_at
from arm.model import Effect
from arm.simulation import simulate
from limbcal.errors import ConfigError


def test_without_effects_the_joint_gets_what_is_asked(arm):
    for table in (no_effects(3), effect_table(arm)):
        assert not (table.driven or table.geared or table.directed.any()) and len(table.joint) == 0
        assert table.parameters.shape == (0, 5) and table.payload.shape == (0, 2)
        np.testing.assert_array_equal(
            table.numbers[[FACTOR, LIMIT, STIFFNESS]], [[1.0] * 3, [np.inf] * 3, [np.inf] * 3]
        )
        assert table.numbers.shape == (8, 3)
        np.testing.assert_array_equal(table.numbers[[DELAY, LAG, GAP, DAMPING, ROTOR]], 0.0)


def test_each_effect_at_a_joint_has_its_function(arm, having):
    both = replace(arm, effects=(Effect("viscous", {"viscous_N_m_s": 0.2}, (3, 1)),))
    both = having(both, "stribeck", joint=2, amplitude_N_m=0.7, velocity_rad_s=0.2)
    table = effect_table(both)
    assert table.joint.tolist() == [2, 0, 1]
    state = np.array([0.0, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0])
    found = [torque_at(a, state, p) for a, p in zip(table.address, table.parameters, strict=True)]
    np.testing.assert_allclose(found, [0.08, 0.08, 0.7 * np.exp(-4.0)])


@pytest.mark.parametrize(
    ("name", "numbers", "directed"),
    [
        ("viscous", {"viscous_N_m_s": 0.2}, False),
        ("coulomb", {"coulomb_N_m": 0.2}, True),
        ("coulomb_asymmetry", {"difference_N_m": 0.2}, False),
        ("stribeck", {"amplitude_N_m": 0.2, "velocity_rad_s": 0.1}, True),
        ("load_friction", {"coefficient": 0.2}, True),
        ("thermal_drift", {"rate_1_s": 0.02}, True),
        ("joint_spring", {"stiffness_N_m_rad": 2.0, "rest_angle_rad": 0.0}, False),
        ("periodic_disturbance", {"amplitude_N_m": 2.0, "frequency_hz": 1.0, "phase_rad": 0.0}, False),
    ],
)
def test_what_depends_on_the_direction_is_known(arm, having, name, numbers, directed):
    table = effect_table(having(arm, name, joint=2, **numbers))
    assert table.directed.tolist() == [False, directed, False] and not table.driven


def test_warming_of_no_friction_has_no_direction(wheel, having, rubbing):
    warm = {"rate_1_s": 0.02}
    assert not effect_table(having(wheel, "thermal_drift", **warm)).directed.any()
    assert effect_table(having(rubbing(wheel, 0.0, 0.1), "thermal_drift", **warm)).directed.all()


@pytest.mark.parametrize(
    ("name", "numbers", "rows", "driven", "geared"),
    [
        ("actuator_delay", {"delay_s": 0.3}, {DELAY: 0.3}, True, False),
        ("actuator_lag", {"time_constant_s": 0.3}, {LAG: 0.3}, True, False),
        ("gain_error", {"factor": 0.3}, {FACTOR: 0.3}, True, False),
        ("torque_saturation", {"limit_N_m": 0.3}, {LIMIT: 0.3}, True, False),
        ("backlash", {"gap_rad": 0.3}, {GAP: 0.3}, True, True),
        (
            "joint_elasticity",
            {"stiffness_N_m_rad": 3.0, "damping_N_m_s": 0.3},
            {STIFFNESS: 3.0, DAMPING: 0.3},
            True,
            True,
        ),
        ("rotor_inertia", {"inertia_kg_m2": 0.3}, {ROTOR: 0.3}, False, False),
        ("gain_error", {"factor": 1.0}, {}, False, False),
        ("backlash", {"gap_rad": 0.0}, {}, False, False),
    ],
)
def test_the_torques_way_is_in_the_numbers_of_its_joints(arm, name, numbers, rows, driven, geared):
    table = effect_table(replace(arm, effects=(Effect(name, numbers, (1, 3)),)))
    expected = no_effects(3).numbers
    for row, value in rows.items():
        expected[row, [0, 2]] = value
    np.testing.assert_array_equal(table.numbers, expected)
    assert (table.driven, table.geared) == (driven, geared) and len(table.joint) == 0


def test_payloads_stand_in_the_order_of_their_times(arm, having):
    loaded = having(arm, "payload", mass_kg=0.5, since_s=7.0, trials=[1, 3])
    loaded = having(having(loaded, "payload", mass_kg=0.2), "payload", mass_kg=0.3, since_s=2.0)
    assert effect_table(loaded, 1).payload.tolist() == [[-np.inf, 0.2], [2.0, 0.3], [7.0, 0.5]]
    later = effect_table(loaded, 3).payload.tolist()  # there all along
    assert sorted(later) == [[-np.inf, 0.2], [-np.inf, 0.5], [2.0, 0.3]] and later[-1] == [2.0, 0.3]
    assert effect_table(loaded, 2).payload.tolist() == [[-np.inf, 0.2], [2.0, 0.3]]
    assert len(effect_table(loaded).payload) == 3  # the first trial unless another is meant


def test_changes_of_the_arm_are_made_one_after_the_other(arm, having):
    twice = having(having(arm, "stiction", static_N_m=0.7), "gravity_tilt", gx_m_s2=1.0, gy_m_s2=0.0)
    twice = having(having(twice, "stiction", static_N_m=0.9), "viscous", viscous_N_m_s=0.1)
    found = changed(twice)
    assert found.joints[0].friction.static_N_m == 0.9 and found.gravity_m_s2[0] == arm.gravity_m_s2[0] + 1.0
    assert found.effects == twice.effects and changed(arm) is arm


def test_an_effect_that_the_catalogue_has_not_is_refused(arm, having):
    with pytest.raises(ConfigError, match="gap_rad is 7.0, expected a number from 0 to 1"):
        changed(having(arm, "backlash", gap_rad=7.0))


def test_effects_may_be_on_several_joints_and_several_times(arm):
    twice = replace(arm, effects=(Effect("viscous", {"viscous_N_m_s": 0.2}, (1, 3)),) * 2)
    friction = [
        replace(j.friction, viscous_N_m_s=j.friction.viscous_N_m_s + 0.4 * (i != 1))
        for i, j in enumerate(arm.joints)
    ]
    same = replace(arm, joints=tuple(replace(j, friction=f) for j, f in zip(arm.joints, friction, strict=True)))
    ref = np.tile([0.6, -0.3, 0.5], (500, 1))
    runs = [simulate(each, ref, 1e-3, np.full(3, 0.2)).q for each in (twice, same)]
    np.testing.assert_allclose(runs[0], runs[1], rtol=0, atol=1e-11)
