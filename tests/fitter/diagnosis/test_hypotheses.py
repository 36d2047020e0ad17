"""Every effect of the catalogue is sought wherever it can be."""

import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.hypotheses import hypotheses

#: How often an arm of three joints is asked about an effect.
PLACES = {
    "gravity_tilt": 1,  # the whole arm
    "joint_zero": 3,
    "air_drag": 2,  # at the first joint it is quadratic drag
    "payload": 0,  # an event
    "external_push": 0,
    "gain_error": 3,
    "actuator_delay": 4,  # each, and all alike
    "end_stop": 6,  # either side
    "thermal_drift": 3,
    "viscous": 0,  # in the base model
    "sensor_bias": 0,
    "stiction": 0,  # shown by rests
}


def count(name, **given):
    return sum(one.kind.name == name for one in hypotheses(3, **given))


@pytest.mark.parametrize("name", PLACES)
def test_places(name):
    assert count(name) == PLACES[name]


def test_all_effects_of_joints_are_sought_without_a_word_about_them():
    at_joints = {name for name, kind in catalogue().items() if kind.place == "joint"}
    sought = {one.kind.name for one in hypotheses(1)}
    assert at_joints - sought == {"viscous", "coulomb", "external_push"}


def test_a_friction_that_the_base_model_is_denied_is_sought():
    assert count("coulomb", denied=("fc",)) == 3 and count("viscous", denied=("fc",)) == 0


def test_without_a_torque_nothing_goes_wrong_on_its_way():
    gone = {one.kind.name for one in hypotheses(2)} - {one.kind.name for one in hypotheses(2, driven=False)}
    drives = {name for name, kind in catalogue().items() if kind.place in ("drive", "transmission")}
    assert gone == drives | {"load_friction"}
