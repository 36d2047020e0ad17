"""The evidence of pulses: gains against costs of places and sizes."""

from itertools import pairwise

import numpy as np
import pytest

from fitter.diagnosis.torque.likeliest_pulses import at_likeliest
from fitter.diagnosis.torque.pulse import Pulse, Shapes
from fitter.diagnosis.torque.pulse_evidence import cost, count_places, log_places, residual_log_evidence
from tests.fitter.diagnosis.torque.residuals import STEP_S, finer, trial


def pulse(start_s: float = 3.0, evidence: float = 7.0) -> Pulse:
    return Pulse(0, 0, start_s, 0.4, 1.0, *[0.1] * 4, "rectangular", 10.0, evidence)


def test_places_of_a_number_of_pulses_are_counted_as_sets():
    n = 50
    sets = [n, n * (n - 1) / 2, n * (n - 1) * (n - 2) / 6]
    # Of k pulses each set has the probability 1 / (k (k + 1)) / their number.
    costs = [np.log(k * (k + 1) * number) for k, number in enumerate(sets, 1)]
    assert log_places(n, 1) == pytest.approx(costs[0])
    for k, (fewer, more) in enumerate(pairwise(costs), 2):
        assert log_places(n, k) == pytest.approx(more - fewer)
    assert log_places(n, 0) == 0.0


def test_the_cost_is_that_of_all_places_and_of_the_sizes():
    assert cost([], 100) == 0.0
    both = [pulse(), pulse(6.0)]
    assert cost(both, 100) == pytest.approx(2 * 3.0 + log_places(100, 1) + log_places(100, 2))


def test_every_joint_has_the_places_of_all_rows_that_are_known():
    rows = [trial(np.random.default_rng(0)).rows(0)]
    per_joint = int(np.count_nonzero(Shapes.of(rows[0]).fit(rows[0])))
    assert count_places(rows, 2) == 2 * per_joint
    longest = round(1.0 / STEP_S)
    assert per_joint > len(rows[0].t) - longest
    rows[0].known[:] = False
    assert count_places(rows, 2) == 0


@pytest.mark.parametrize(("size", "more"), [(1.0, True), (0.0, False)])
def test_a_residual_is_likelier_with_a_pulse_only_if_it_has_one(size, more):
    hidden = [(3.0, 0.4, size, "rectangular")]
    part = finer(trial(np.random.default_rng(5), hidden))
    found = at_likeliest([part], [pulse()])
    assert (residual_log_evidence([part], found) > residual_log_evidence([part], [])) == more
