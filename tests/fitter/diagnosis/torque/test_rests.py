"""Rests tell where a push that friction cannot hold begins and ends."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Background, Rows
from fitter.diagnosis.torque.pulse_column import in_rows
from fitter.diagnosis.torque.pulse_search import Search
from fitter.diagnosis.torque.rests import amid, filtered_with_rests, unseen, with_rests
from tests.fitter.diagnosis.torque.residuals import trial

FRICTION_N_M = 0.1
MODEL = Background(0.05, 0.3, 1e-6, 20.0, 0.5, np.full(2, 1e-9), np.ones(2), 1e-6, 1e-9, 30.0, 1e-9)


def resting(held: float = 0.5 * FRICTION_N_M) -> Rows:
    """Return rows of a joint that rests from 3.6 s to 4.04 s; of a row more at either side nothing is known."""
    rows = trial(np.random.default_rng(7)).rows(0)
    rows.known[89:103] = False
    rows.at_rest[89:103] = True
    rows.turning[90:102] = 1.0
    rows.r[90:102] += held
    rows.friction[:] = FRICTION_N_M
    return rows


@pytest.mark.parametrize("known", [resting(), replace(resting(), at_rest=np.zeros(250, dtype=bool))])
def test_an_end_is_unseen_where_no_row_tells(known):
    assert unseen(known, 4.09, -1) == pytest.approx((3.54, 4.1))
    assert unseen(known, 4.11, -1) == pytest.approx((3.54, 4.1))  # the row next to it
    assert unseen(known, 3.57, 1) == pytest.approx((3.54, 4.1))
    assert unseen(known, 4.4, -1) == unseen(known, 4.4, 1) == (4.4, 4.4)


def test_rows_at_rest_tell_of_what_friction_cannot_hold():
    assert unseen(with_rests(resting()), 4.09, -1) == (4.09, 4.09)


def test_ends_are_amid_what_is_unseen_of_them():
    rows = resting()
    assert amid(rows, 3.2, 0.36) == pytest.approx((3.2, 0.62, 0.0, 0.56))
    assert amid(rows, 3.6, 0.9) == pytest.approx((3.82, 0.68, 0.56, 0.0))
    assert amid(with_rests(rows), 3.6, 0.9) == pytest.approx((3.6, 0.9, 0.0, 0.0))


@pytest.mark.parametrize("held", [-FRICTION_N_M, 0.0, FRICTION_N_M])
def test_what_holds_a_joint_within_its_friction_is_no_news(held):
    rows = resting(held)
    e = filtered_with_rests(MODEL, rows).innovations(rows.r)[89:103]
    assert np.abs(e).max() < 4.0


@pytest.mark.parametrize("held", [-FRICTION_N_M, 0.0, FRICTION_N_M])
@pytest.mark.parametrize(("start_s", "lasting_s"), [(3.88, 0.4), (3.3, 0.5)])
def test_a_push_begins_and_ends_in_a_rest_where_the_rest_says_so(held, start_s, lasting_s):
    torque = 10.0 * FRICTION_N_M
    rows = resting(held)
    rows = replace(rows, r=rows.r + torque * in_rows(rows, start_s, lasting_s, "rectangular"))
    search = Search(0, 0, rows, MODEL, torque)
    found = search.near((start_s + 0.1 * lasting_s, 0.8 * lasting_s), 0.0)
    assert found.start_s == pytest.approx(start_s, abs=4.0 * found.start_std)
    assert found.duration_s == pytest.approx(lasting_s, abs=4.0 * found.duration_std)
    assert found.torque_N_m == pytest.approx(torque, abs=4.0 * found.torque_std)
    assert max(found.start_std, found.duration_std) < 0.02  # half a row
