"""Every effect of the catalogue is sought wherever it can be."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Arm, Body, Joint
from fitter.diagnosis.hypotheses import Reach, hypotheses, reaches_of

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
    "passive_tissue": 0,  # a machine has none
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
    assert at_joints - sought == {"viscous", "coulomb", "external_push", "passive_tissue"}


def test_tissue_is_sought_at_both_ends_of_what_a_persons_turning_joints_reach():
    joints = (Joint(type="prismatic"), Joint(), Joint())
    q = np.array([[0.0, -0.5, 0.1], [1.0, 0.7, 0.2]])
    assert not any(reach.lives for reach in reaches_of(Arm("machine", joints), [q]))
    reaches = reaches_of(Arm("leg", joints, body=Body("human-leg-right", 70.0, 1.75, "f")), [q, q + 0.1])
    ends = {1: (-0.5, pytest.approx(0.8)), 2: (0.1, pytest.approx(0.3))}
    assert {j: (reach.low, reach.high) for j, reach in enumerate(reaches) if reach.lives} == ends
    tissue = [one for one in hypotheses(3, reaches=reaches) if one.kind.name == "passive_tissue"]
    assert [(one.joints, one.choice["side"], one.choice["angle_rad"]) for one in tissue] == [
        ((j,), side, ends[j][end]) for j in (1, 2) for end, side in enumerate((-1.0, 1.0))
    ]


@pytest.mark.parametrize(
    ("reach", "first", "second"),
    [
        (Reach(-4.0, 4.0), 1.0, 2.0),  # once a turn
        (Reach(0.0, 1.0), 7.0, 8.0),
        (Reach(0.0, 0.25, slides=True), 8.0 * np.pi, 16.0 * np.pi),
    ],
)
def test_a_ripple_comes_round_within_what_a_joint_reaches(reach, first, second):
    (cogging,) = (one for one in hypotheses(1, reaches=[reach]) if one.kind.name == "cogging")
    assert cogging.low == pytest.approx([first]) and cogging.periods[:2] == pytest.approx([first, second])


def test_a_friction_that_the_base_model_is_denied_is_sought():
    assert count("coulomb", denied=("fc",)) == 3 and count("viscous", denied=("fc",)) == 0


def test_without_a_torque_nothing_goes_wrong_on_its_way():
    gone = {one.kind.name for one in hypotheses(2)} - {one.kind.name for one in hypotheses(2, driven=False)}
    drives = {name for name, kind in catalogue().items() if kind.place in ("drive", "transmission")}
    assert gone == drives | {"load_friction"}
