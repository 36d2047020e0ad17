"""A rest limits where a push that friction cannot hold begins and ends."""

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Rows
from fitter.diagnosis.torque.rests import outside, unseen_s
from tests.fitter.diagnosis.torque.residuals import trial

FRICTION_N_M = 0.1


def resting() -> Rows:
    """Return rows of a joint that rests from 3.6 s to 4.04 s; of a row more at either side nothing is known."""
    rows = trial(np.random.default_rng(7)).rows(0)
    rows.known[89:103] = False
    rows.turning[90:102] = 1.0
    rows.friction[:] = FRICTION_N_M
    return rows


@pytest.mark.parametrize(("torque", "unseen"), [(0.5 * FRICTION_N_M, 0.56), (3.0 * FRICTION_N_M, 0.08)])
def test_what_friction_holds_may_begin_anywhere_in_a_rest_and_no_more_only_beside_it(torque: float, unseen: float):
    rows = resting()
    assert unseen_s(rows, 4.09, -1, torque) == pytest.approx(unseen, abs=0.05)
    assert unseen_s(rows, 3.57, 1, torque) == pytest.approx(unseen, abs=0.05)
    assert unseen_s(rows, 4.4, -1, torque) == unseen_s(rows, 4.4, 1, torque) == 0.0


@pytest.mark.parametrize(
    ("push", "expected"),
    [((3.8, 1.0), (4.06, 0.74)), ((3.2, 0.6), (3.2, 0.38)), ((3.2, 1.5), (3.2, 1.5)), ((3.7, 0.2), (3.7, 0.2))],
)
def test_a_push_that_no_friction_holds_acts_outside_of_the_rest(push, expected):
    assert outside(resting(), *push, 3.0 * FRICTION_N_M) == pytest.approx(expected, abs=0.021)
    assert outside(resting(), *push, FRICTION_N_M) == pytest.approx(push)
