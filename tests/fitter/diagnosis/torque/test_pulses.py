"""Pulses are found in coloured residuals, with their errors; what is no pulse is not."""


import numpy as np
import pytest

from fitter.diagnosis.torque.pulses import find_pulses
from tests.fitter.diagnosis.torque.residuals import trial

HIDDEN = {0: [(2.0, 0.2, 0.5, "rectangular"), (6.5, 0.25, -0.6, "bell")], 2: [(4.0, 0.3, 0.4, "rectangular")]}


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
