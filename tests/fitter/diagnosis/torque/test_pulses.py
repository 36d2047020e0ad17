"""Pulses are found in coloured residuals, with their errors; what is no pulse is not."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.pulse import Pulse, either, pulse_means, unseen_s
from fitter.diagnosis.torque.pulses import find_pulses
from tests.fitter.diagnosis.torque.residuals import trial

HIDDEN = {0: [(2.0, 0.2, 0.5, "rectangular"), (6.5, 0.25, -0.6, "bell")], 2: [(4.0, 0.3, 0.4, "rectangular")]}


@pytest.mark.parametrize("form", ["rectangular", "bell"])
def test_a_pulse_is_at_half_its_size_at_its_ends(form):
    t = np.arange(0.0, 2.0, 1e-3)
    shape = pulse_means(t, 1e-3, 0.7, 0.4, form)
    above = t[shape > 0.5]
    assert (above[0], above[-1]) == pytest.approx((0.7, 1.1), abs=2e-3)
    assert shape.max() == pytest.approx(1.0, abs=1e-4)
    assert shape.sum() * 1e-3 == pytest.approx(0.4)


def test_all_pulses_are_found_and_no_others():
    rng = np.random.default_rng(4)
    found = find_pulses([trial(rng, HIDDEN.get(k, ())) for k in range(3)])
    hidden = [(k, *pulse) for k, pulses in HIDDEN.items() for pulse in pulses]
    assert [pulse.trial for pulse in found] == [k for k, *_ in hidden]
    for pulse, (_, start_s, duration_s, size, _) in zip(found, hidden, strict=True):
        assert pulse.joint == 0
        assert pulse.start_s == pytest.approx(start_s, abs=0.05)
        assert pulse.duration_s == pytest.approx(duration_s, abs=0.06)
        assert abs(pulse.torque_N_m - size) < 3.5 * pulse.torque_std
        assert 0.0 < pulse.start_std < 0.05
        assert 0.0 < pulse.duration_std < 0.05


def test_single_rows_of_great_error_are_no_pulses():
    rng = np.random.default_rng(5)
    outlying = trial(rng)
    at = rng.integers(0, len(outlying.t), 12)
    outlying.r[at, 0] += rng.choice([-1.0, 1.0], 12) * 0.4
    assert find_pulses([outlying, trial(rng)]) == []


def test_nothing_is_found_where_nothing_is_known():
    part = trial(np.random.default_rng(6), [(4.0, 0.3, 0.6, "rectangular")])
    part.known[95:115] = False
    assert find_pulses([part]) == []


def test_beside_rows_that_are_not_known_an_instant_may_be_anywhere_in_them():
    rows = trial(np.random.default_rng(7)).rows(0)
    rows.known[90:102] = False  # from 3.58 s to 4.06 s
    for at_s in (4.05, 4.08):  # among them and in the row next to them
        assert unseen_s(rows, at_s, -1) == pytest.approx(0.48, abs=0.05)
    assert unseen_s(rows, 3.57, 1) == pytest.approx(0.48, abs=0.05)
    assert unseen_s(rows, 4.2, -1) == unseen_s(rows, 4.2, 1) == unseen_s(rows, 4.08, 1) == 0.0


def test_a_form_that_might_be_another_has_the_error_of_both():
    bell = Pulse(0, 0, 1.0, 0.2, 0.6, 0.01, 0.01, 0.03, "bell", 20.0, 15.0)
    for less, error in ((0.0, np.hypot(0.03, 0.1 / np.sqrt(2.0))), (30.0, 0.03)):
        other = replace(bell, form="rectangular", torque_N_m=0.5, log_likelihood_ratio=20.0 - less)
        one = either([other, bell])
        assert one.torque_std == pytest.approx(error, rel=1e-3)
