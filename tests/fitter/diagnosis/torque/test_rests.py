"""A rest limits where a push that friction cannot hold begins and ends."""

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Rows
from fitter.diagnosis.torque.rests import amid, outside, unseen
from tests.fitter.diagnosis.torque.residuals import trial

FRICTION_N_M = 0.1


def resting() -> Rows:
    """Return rows of a joint that rests from 3.6 s to 4.04 s; of a row more at either side nothing is known."""
    rows = trial(np.random.default_rng(7)).rows(0)
    rows.known[89:103] = False
    rows.turning[90:102] = 1.0
    rows.held[90:102] = 0.5 * FRICTION_N_M
    rows.friction[:] = FRICTION_N_M
    return rows


@pytest.mark.parametrize(
    ("torque", "begins", "ends"),
    [(0.5 * FRICTION_N_M, (3.54, 4.1), (3.54, 4.1)), (3.0 * FRICTION_N_M, (4.06, 4.1), (3.54, 3.58))],
)
def test_what_friction_holds_may_begin_anywhere_in_a_rest_and_no_more_only_beside_it(torque, begins, ends):
    rows = resting()
    assert unseen(rows, 4.09, -1, torque) == pytest.approx(begins)
    assert unseen(rows, 4.11, -1, torque) == pytest.approx(begins)  # the row next to it
    assert unseen(rows, 3.57, 1, torque) == pytest.approx(ends)
    assert unseen(rows, 4.4, -1, torque) == unseen(rows, 4.4, 1, torque) == (4.4, 4.4)


def test_ends_are_amid_what_is_unseen_of_them():
    rows = resting()
    assert amid(rows, 3.2, 0.36, 1.0) == pytest.approx((3.2, 0.36, 0.0, 0.04))
    assert amid(rows, 4.07, 0.63, 1.0) == pytest.approx((4.08, 0.62, 0.04, 0.0))
    assert amid(rows, 3.6, 0.9, FRICTION_N_M) == pytest.approx((3.82, 0.68, 0.56, 0.0))


@pytest.mark.parametrize(
    ("push", "expected"),
    [((3.8, 1.0), (4.06, 0.74)), ((3.2, 0.6), (3.2, 0.38)), ((3.2, 1.5), (3.2, 1.5)), ((3.7, 0.2), (3.7, 0.2))],
)
def test_a_push_that_no_friction_holds_acts_outside_of_the_rest(push, expected):
    assert outside(resting(), *push, 3.0 * FRICTION_N_M) == pytest.approx(expected)
    assert outside(resting(), *push, FRICTION_N_M) == pytest.approx(push)


def test_where_more_is_missed_than_friction_holds_a_joint_may_already_move():
    rows = resting()
    rows.held[98:102] = 2.0 * FRICTION_N_M  # the last .16 s of the rest
    assert outside(rows, 3.8, 1.0, 3.0 * FRICTION_N_M) == pytest.approx((3.9, 0.9))
    assert unseen(rows, 4.09, -1, 3.0 * FRICTION_N_M) == pytest.approx((3.9, 4.1))
