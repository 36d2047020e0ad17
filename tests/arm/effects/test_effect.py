"""What effects are made of: numbers, vectors, and arms of which one part is changed."""

from dataclasses import replace

import pytest

from arm.arm_file import load_arm
from arm.effects.catalogue import catalogue
from arm.effects.effect import (
    EffectKind,
    Parameter,
    number,
    total,
    vector,
    with_joints,
    with_markers,
    with_sensors,
)
from arm.model import Marker

ARM = replace(load_arm("spatial-arm"), markers=(Marker("A", 1), Marker("B", 2)))
NUMBER = Parameter("x", "m", 0.0, 1.0)


@pytest.mark.parametrize(
    ("place", "listed"),
    [
        ("joint", "joints"),
        ("arm", "joints"),
        ("drive", "joints"),
        ("transmission", "joints"),
        ("sensor", "sensors"),
        ("marker", "markers"),
    ],
)
def test_an_entry_lists_what_it_acts_on(place, listed):
    kind = EffectKind("it", "something is the matter", place, (NUMBER,))
    assert kind.acts_on == listed
    assert replace(kind, whole=True).acts_on == "arm"


def test_a_number_may_be_whole():
    assert isinstance(number({"x": 2}, "x"), float) and number({"x": 2}, "x") == 2.0
    with pytest.raises(AssertionError):
        number({"x": "2"}, "x")


def test_three_numbers_in_their_order_are_a_vector():
    assert vector({"x": 1, "y": 2.5, "z": -3}, "z", "x", "y") == (-3.0, 1.0, 2.5)


def test_vectors_add_up_component_by_component():
    assert total((1.0, 2.0, 3.0), (10.0, -20.0, 0.5)) == (11.0, -18.0, 3.5)


def test_joints_counted_from_one_are_changed():
    found = with_joints(ARM, (1, 3), lambda joint: replace(joint, a_m=9.0))
    assert [joint.a_m for joint in found.joints] == [9.0, 0.3, 9.0]
    assert with_joints(found, (1, 3), lambda joint: joint) == found


def test_sensors_and_markers_are_changed_by_name():
    found = with_sensors(ARM, ("s2", "s6"), lambda sensor: replace(sensor, joint=9))
    assert [sensor.joint for sensor in found.sensors] == [1, 9, 2, 2, 3, 9]
    moved = with_markers(ARM, ("B",), lambda marker: replace(marker, joint=0))
    assert [marker.joint for marker in moved.markers] == [1, 0] and moved.sensors == ARM.sensors


def test_what_holds_a_resting_joint_is_said(resists):
    """Those that hold by more than Coulomb friction differ by direction at rest, or keep it off centre."""
    numbers = {p.name: 0.3 for p in catalogue()["stribeck"].numbers}
    ahead, back = resists("stribeck", numbers, dq=0.0, direction=[1.0, -1.0])
    assert ahead == -back != 0.0 and catalogue()["stribeck"].holds


def test_by_default_an_effect_is_nothing_special():
    kind = EffectKind("it", "something is the matter", "joint", (NUMBER,))
    assert not (
        kind.whole or kind.holds or kind.event or kind.usual or kind.is_living or kind.base or kind.stated_at
    )
    assert not (NUMBER.linear or NUMBER.optional or NUMBER.several) and NUMBER.neutral is None


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
