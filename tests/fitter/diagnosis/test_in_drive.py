"""Torque that comes late or slowly, against closed forms."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fitter.diagnosis.in_drive import delayed, lagging

DT = 0.002


@given(st.floats(0.0, 0.08))
def test_a_delayed_sine_is_a_sine_that_is_late(delay):
    t = np.arange(1000) * DT
    late = delayed(np.sin(7.0 * t), delay, DT)
    after = (t > delay + 3 * DT) & (t < t[-1] - 3 * DT)  # the last samples' curvature is not known
    np.testing.assert_allclose(late[after], np.sin(7.0 * (t - delay))[after], atol=1e-6)


@given(st.floats(0.001, 0.2))
def test_a_lagging_ramp_follows_by_the_time_constant(T):
    t = np.arange(2000) * DT
    followed = lagging(3.0 * t, T, DT)
    np.testing.assert_allclose(followed, 3.0 * (t - T * (1.0 - np.exp(-t / T))), atol=1e-9)


def test_what_does_not_change_is_not_changed():
    constant = np.full(50, 1.7)
    np.testing.assert_allclose(delayed(constant, 0.01, DT), 1.7)
    np.testing.assert_allclose(lagging(constant, 0.01, DT), 1.7)
