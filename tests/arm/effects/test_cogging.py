"""A torque that ripples with the angle."""

import numpy as np
import pytest

from arm.simulation import simulate

RIPPLE = {"amplitude_N_m": 0.4, "phase_rad": 0.7, "periods_per_turn": 8.0}


def test_it_ripples_so_many_times_a_turn(resists):
    q = np.linspace(0.0, 2.0 * np.pi, 9)  # a period apart
    np.testing.assert_allclose(resists("cogging", RIPPLE, q=q), -0.4 * np.sin(0.7), rtol=1e-12)
    np.testing.assert_allclose(resists("cogging", RIPPLE, q=q + np.pi / 8.0), 0.4 * np.sin(0.7), rtol=1e-12)


def test_at_its_phase_it_drives_with_its_amplitude(resists):
    at_most = (np.pi / 2.0 - 0.7) / 8.0
    assert resists("cogging", RIPPLE, q=at_most) == pytest.approx(-0.4)
    assert resists("cogging", RIPPLE, q=-0.7 / 8.0) == pytest.approx(0.0, abs=1e-15)


def test_it_gives_back_what_it_took(wheel, having):
    none = np.zeros((5000, 1))
    motion = simulate(
        having(wheel, "cogging", **RIPPLE), none, 4e-4, np.array([-1.2]), np.array([3.0]), torque=none
    )
    energy = 0.5 / 2 * motion.dq**2 + 0.4 / 8.0 * np.cos(8.0 * motion.q + 0.7)
    assert np.ptp(motion.q) > 3.0
    np.testing.assert_allclose(energy, energy[0, 0], rtol=3e-6)


def test_it_holds_a_resting_joint_off_centre(wheel, having, rubbing, let_go):
    numbers = {"amplitude_N_m": 0.2, "phase_rad": np.pi / 2, "periods_per_turn": 6.0}
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "cogging", **numbers)
    assert let_go(arm) == pytest.approx(0.2, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-0.6, abs=1.1e-3)


def test_what_it_may_be(ranges):
    ranges("cogging", "amplitude_N_m", 0.0, 1e3, phase_rad=0.0, periods_per_turn=1.0)
    ranges("cogging", "phase_rad", -6.3, 6.3, amplitude_N_m=1.0, periods_per_turn=1.0)
    ranges("cogging", "periods_per_turn", 0.1, 1e3, amplitude_N_m=1.0, phase_rad=0.0)
