"""What an effect says of its numbers."""

import pytest

from arm.effects.catalogue import catalogue


@pytest.mark.parametrize(
    ("effect", "parameter", "sliding"),
    [
        ("joint_spring", "stiffness_N_m_rad", "N/m"),
        ("joint_spring", "rest_angle_rad", "m"),
        ("viscous", "viscous_N_m_s", "N s/m"),
        ("quadratic_drag", "drag_N_m_s2", "N s^2/m^2"),
        ("rotor_inertia", "inertia_kg_m2", "kg"),
        ("stribeck", "velocity_rad_s", "m/s"),
        ("cogging", "phase_rad", "rad"),
        ("payload", "mass_kg", "kg"),
    ],
)
def test_at_a_sliding_joint_units_are_those_of_lengths(effect, parameter, sliding):
    (found,) = (one for one in catalogue()[effect].parameters if one.name == parameter)
    assert found.unit_at("prismatic") == sliding
    assert found.unit_at("revolute") == found.unit
