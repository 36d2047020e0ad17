"""A torque at a fixed frequency."""

import numpy as np
import pytest

from arm.simulation import simulate

HUM = {"amplitude_N_m": 0.3, "frequency_hz": 2.0, "phase_rad": 0.4}


def test_it_comes_again_after_a_period(resists):
    t = np.array([0.0, 0.5, 7.0])
    np.testing.assert_allclose(resists("periodic_disturbance", HUM, t=t), -0.3 * np.sin(0.4), rtol=1e-12)
    np.testing.assert_allclose(resists("periodic_disturbance", HUM, t=t + 0.25), 0.3 * np.sin(0.4), rtol=1e-12)


def test_at_its_phase_it_drives_with_its_amplitude(resists):
    quarter = (np.pi / 2.0 - 0.4) / (4.0 * np.pi)
    assert resists("periodic_disturbance", HUM, t=quarter) == pytest.approx(-0.3)


def test_it_goes_on_from_trial_to_trial(wheel, having):
    arm, ref = having(wheel, "periodic_disturbance", **HUM), np.full((1101, 1), 0.3)
    whole = simulate(arm, np.tile(ref, (2, 1))[:2201], 1e-3, np.zeros(1))
    second = simulate(arm, ref, 1e-3, whole.q[1100], whole.dq[1100], t0_s=1.1)
    np.testing.assert_allclose(second.q, whole.q[1100:], rtol=0, atol=1e-9)
    assert not np.allclose(second.q, simulate(arm, ref, 1e-3, whole.q[1100], whole.dq[1100]).q, atol=1e-3)


def test_what_it_may_be(ranges):
    ranges("periodic_disturbance", "amplitude_N_m", 0.0, 1e3, frequency_hz=1.0, phase_rad=0.0)
    ranges("periodic_disturbance", "frequency_hz", 1e-2, 1e4, amplitude_N_m=1.0, phase_rad=0.0)
    ranges("periodic_disturbance", "phase_rad", -6.3, 6.3, amplitude_N_m=1.0, frequency_hz=1.0)
