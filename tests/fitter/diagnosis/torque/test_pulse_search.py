"""The search of one trial: the evidence for the places of a pulse."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.background import Background
from fitter.diagnosis.torque.pulse import without
from fitter.diagnosis.torque.pulse_column import in_rows
from fitter.diagnosis.torque.pulse_search import Search
from fitter.diagnosis.torque.student_ratio import likeliest_ratio
from tests.fitter.diagnosis.torque.residuals import filtered_pulse, finer, trial

MODEL = Background(0.05, 0.3, 1e-6, 20.0, 0.5, np.full(2, 1e-9), np.ones(2), 1e-6, 1e-9, 30.0, 1e-9)
LEAST_NATS = 8.0


def search(pulses):
    rows = trial(np.random.default_rng(4), pulses).rows(0)
    return Search(3, 1, rows, MODEL, 0.5)


def test_the_most_evident_pulse_comes_first_and_none_overlaps_another():
    found = list(search([(2.0, 0.2, 0.4, "rectangular"), (6.0, 0.3, -0.8, "rectangular")]).found(LEAST_NATS))
    assert [one.torque_N_m > 0.0 for one in found] == [False, True]
    assert [one.start_s for one in found] == pytest.approx([6.0, 2.0], abs=0.06)
    assert found[0].evidence > found[1].evidence >= LEAST_NATS
    assert {(one.trial, one.joint) for one in found} == {(3, 1)}


def test_evidence_below_the_least_is_no_pulse():
    assert list(search([(2.0, 0.2, 0.4, "rectangular")]).found(1e6)) == []


def test_evidence_does_not_depend_on_where_between_the_places_a_pulse_lies():
    rows = trial(np.random.default_rng(4), [(2.0, 0.2, 3.0, "rectangular")]).rows(0)
    begun = [(Search(0, 0, rows, MODEL, 0.5), 0.0)]
    between = trial(np.random.default_rng(4), [(2.0 + 0.5 * rows.step_s, 0.24, 3.0, "rectangular")]).rows(0)
    begun.append((Search(0, 0, between, MODEL, 0.5), 0.0))
    one, other = (next(search.found(LEAST_NATS)) for search, _ in begun)
    occam = [pulse.log_likelihood_ratio - pulse.evidence for pulse in (one, other)]
    assert occam[0] == pytest.approx(occam[1], abs=2.0)
    assert all(-1.0 < cost < 20.0 for cost in occam)


@pytest.mark.parametrize(("friction", "found"), [(0.15, 1), (0.25, 0)])
def test_what_goes_on_into_a_rest_may_be_friction(friction, found):
    """Friction of a joint that comes to rest may differ by twice its own; a pulse of 0.4 N m is more, or less."""
    rows = trial(np.random.default_rng(4), [(2.0, 0.4, 0.4, "rectangular")]).rows(0)
    rows.friction[:] = friction
    rows.known[rows.t > 2.3] = False
    search = Search(0, 0, rows, MODEL, 0.5)
    assert len(list(search.found(LEAST_NATS))) == found


def test_a_pulse_that_is_seen_whole_is_no_friction():
    rows = trial(np.random.default_rng(4), [(2.0, 0.4, 0.4, "rectangular")]).rows(0)
    rows.friction[:] = 0.25
    search = Search(0, 0, rows, MODEL, 0.5)
    assert len(list(search.found(LEAST_NATS))) == 1


def test_evidence_is_made_anew_wherever_a_pulse_was_felt():
    one = search([(2.0, 0.2, 0.4, "rectangular"), (6.0, 0.3, -0.8, "rectangular")])
    pulses = [replace(pulse, trial=0) for pulse in one.found(LEAST_NATS)]
    (remaining,) = without([one.rows], pulses)
    whole, _ = one.evidence(remaining.r, one.fit)
    np.testing.assert_allclose(one.remaining_evidence, whole, atol=0.01)


@pytest.mark.parametrize(("start_s", "duration_s"), [(2.0, 0.085), (2.0, 0.09), (2.03, 0.1)])
def test_a_large_pulse_between_the_grids_places_is_found_first(start_s, duration_s):
    """Fifty standard deviations off wherever its place is not exact, it has no evidence on the grid."""
    noise = Background(0.01, 3.0, 0.05, 0.65, 1.0, np.full(2, 1e-9), np.ones(2), 0.04, 1e-9, 3.8, 1e-9)
    part = trial(np.random.default_rng(4))
    pushed = part.r + filtered_pulse(start_s, duration_s, 4.0, "rectangular")[:, None]
    rows = finer(replace(part, r=pushed)).rows(0)
    first = next(Search(0, 0, rows, noise, 0.2).found(LEAST_NATS))
    assert first.start_s == pytest.approx(start_s, abs=0.02)
    assert first.impulse == pytest.approx(4.0 * duration_s, rel=0.05)


@pytest.mark.parametrize("form", ["rectangular", "bell"])
def test_the_size_of_a_pulse_whose_start_is_unseen_is_that_of_where_it_is_put(form):
    rows = trial(np.random.default_rng(4), [(2.0, 0.4, 1.6, form)]).rows(0)
    rows.known[(rows.t > 1.0) & (rows.t < 2.2)] = False
    one = Search(0, 0, rows, MODEL, 0.5)
    first = next(one.found(LEAST_NATS))
    column = in_rows(rows, first.start_s, first.duration_s, first.form)
    e, s = (one.kalman.innovations(part) for part in (rows.r, column))
    assert first.torque_N_m == pytest.approx(likeliest_ratio(e, s, MODEL.degrees_of_freedom)[1], rel=0.05)
