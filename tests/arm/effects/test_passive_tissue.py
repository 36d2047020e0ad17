"""Tissue at an end of a joint's range: its moment by closed form, and that it takes energy."""

import numpy as np
import pytest

from arm.effects.joint_torque import torque_along
from arm.effects.passive_tissue import EFFECT

ANGLE, MOMENT, RATE, DAMPING = 0.4, 2.0, 12.0, 0.3


def moment(q, dq, side):
    state = np.array([[0.0, q, dq, np.sign(dq), 0.0, 0.0, 0.0]])
    return float(torque_along(EFFECT, np.array([ANGLE, MOMENT, RATE, DAMPING, side]), state)[0])


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_grows_e_fold_over_an_inverse_rate_towards_its_end(side):
    assert moment(ANGLE, 0.0, side) == pytest.approx(side * MOMENT)
    assert moment(ANGLE + side / RATE, 0.0, side) == pytest.approx(side * MOMENT * np.e)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_where_it_is_stated_is_a_convention(side):
    other = np.array([0.1, MOMENT * np.exp(RATE * side * (0.1 - ANGLE)), RATE, DAMPING, side])
    state = np.array([[0.0, 0.7, 1.1, 1.0, 0.0, 0.0, 0.0]])
    assert float(torque_along(EFFECT, other, state)[0]) == pytest.approx(moment(0.7, 1.1, side))


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_what_it_takes_on_the_way_in_it_does_not_give_back(side):
    assert (moment(0.5, 1.0, side) - moment(0.5, -1.0, side)) > 0.0
