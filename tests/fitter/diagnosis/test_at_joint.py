"""Columns of an effect at a joint, and its numbers recovered from their factors."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.effects.joint_torque import torque_along
from fitter.diagnosis.at_joint import AtJoint


def _states(n=200):
    rng = np.random.default_rng(1)
    states = rng.normal(size=(n, 7))
    states[:, 3] = np.sign(states[:, 2])
    return states


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("cogging", (0.4, 1.1, 7.0)),
        ("joint_spring", (3.0, -0.4)),
        ("periodic_disturbance", (0.2, 2.5, -2.0)),
        ("stribeck", (0.3, 0.25)),
        ("quadratic_drag", (0.7,)),
    ],
)
def test_numbers_come_back_from_the_factors_of_the_columns(name, values):
    kind = catalogue()[name]
    hypothesis = AtJoint(kind, 0)
    order = [parameter.name for parameter in kind.parameters]
    psi = np.array([values[order.index(one)] for one in hypothesis.psi_names])
    states = _states()
    columns = hypothesis._columns(psi, states)
    torque = torque_along(kind, np.array(values), states)
    factors, left, *_ = np.linalg.lstsq(columns, torque, rcond=None)
    assert columns.shape[1] == hypothesis.n_column
    assert np.all(np.abs(columns @ factors - torque) < 1e-9)
    np.testing.assert_allclose(hypothesis.numbers(psi, factors), values, rtol=1e-5, atol=1e-6)


def test_friction_that_would_push_is_not_possible():
    hypothesis = AtJoint(catalogue()["quadratic_drag"], 0)
    assert hypothesis.possible(np.zeros(0), np.array([0.1]))
    assert not hypothesis.possible(np.zeros(0), np.array([-0.1]))
