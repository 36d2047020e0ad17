"""Which pulses are the same, and how well the form of one is known."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.pulse import Pulse, either

PULSE = Pulse(0, 0, 1.0, 0.2, 5.0, 0.01, 0.02, 0.3, 0.1, "rectangular", 20.0, 15.0)


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ({"start_s": 1.19}, True),
        ({"start_s": 0.85, "duration_s": 0.16}, True),
        ({"start_s": 1.2}, False),
        ({"start_s": 0.8}, False),
        ({"trial": 1}, False),
        ({"joint": 1}, False),
        ({"torque_N_m": -5.0}, False),
    ],
)
def test_pulses_overlap_at_one_joint_at_one_time_in_one_direction(other, expected):
    other = replace(PULSE, **other)
    assert PULSE.overlaps(other) is other.overlaps(PULSE) is expected


def test_a_form_that_might_be_another_has_the_error_of_both():
    bell = Pulse(0, 0, 1.0, 0.2, 0.6, 0.01, 0.01, 0.03, 0.005, "bell", 20.0, 15.0)
    for less, error in ((0.0, np.hypot(0.03, 0.1 / np.sqrt(2.0))), (30.0, 0.03)):
        other = replace(bell, form="rectangular", torque_N_m=0.5, log_likelihood_ratio=20.0 - less)
        one = either([other, bell])
        assert one.torque_std == pytest.approx(error, rel=1e-3)
