"""Hypotheses act from the drive to the link, whatever order they were found in."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.model import Model
from fitter.diagnosis.order import downstream, scales_only

ALL = {one.kind.name: one for one in hypotheses(1)}


def named(names):
    """Return the names of a model's hypotheses in the order in which they act."""
    model = Model()
    for name in names:
        model = model.plus(ALL[name], np.zeros(len(ALL[name].low)))
    return [model.hypotheses[k].kind.name for k in downstream(model)], model


@given(st.permutations(["cogging", "actuator_delay", "gain_error", "torque_saturation"]))
def test_what_acts_on_the_torque_comes_before_columns_are_made_of_it(names):
    order, model = named(names)
    assert order == ["gain_error", "torque_saturation", "actuator_delay", "cogging"]
    assert not scales_only(model)


@given(st.permutations(["cogging", "joint_spring", "gain_error"]))
def test_a_gain_that_nothing_feels_comes_last_and_columns_stay_in_their_order(names):
    order, model = named(names)
    assert scales_only(model)
    assert order == [*(name for name in names if name != "gain_error"), "gain_error"]
