"""What every hypothesis says of itself unless it knows better."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import ActionOrder
from tests.fitter.diagnosis.searched import swinging


@pytest.fixture(scope="module")
def motions():
    return swinging(trials=2).motions


@pytest.mark.parametrize("hypothesis", hypotheses(2), ids=lambda one: f"{one.kind.name}{one.joints}")
def test_its_starts_are_possible_and_its_places_are_as_many_as_they_are(hypothesis, motions):
    if any(j > 0 for j in hypothesis.joints):
        return
    starts = hypothesis.starts(motions)
    assert starts.shape[1] == len(hypothesis.low) == len(hypothesis.high)
    assert np.all(starts >= hypothesis.low) and np.all(starts <= hypothesis.high)
    assert hypothesis.n_number == hypothesis.n_column + len(hypothesis.low)
    assert hypothesis.log_places(motions) >= np.log(len(starts)) or "frequency" in hypothesis.names[1]


@pytest.mark.parametrize(("drag", "is_possible"), [(0.1, True), (-0.1, False)])
def test_numbers_are_possible_within_the_catalogues_bounds(drag, is_possible):
    air = JointHypothesis(catalogue()["quadratic_drag"], 0)
    assert air.possible(np.zeros(0), np.array([drag])) is is_possible


def test_what_no_torque_enters_acts_first_and_what_is_given_last():
    assert list(ActionOrder) == sorted(ActionOrder)
    assert (min(ActionOrder), max(ActionOrder)) == (ActionOrder.BACKLASH, ActionOrder.GIVEN)
    assert ActionOrder.FRICTION < ActionOrder.SCALE < ActionOrder.GIVEN
    assert ActionOrder.GAIN < ActionOrder.LIMIT < ActionOrder.LATENCY < ActionOrder.COLUMNS
