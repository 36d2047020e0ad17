"""Friction that changes as the run goes on."""

import numpy as np

from arm.simulation import simulate

DT = 1e-3


def test_the_files_own_friction_grows_by_its_rate(resists):
    """Friction is 0.6 N m s and 0.35 N m."""
    rate = {"rate_1_s": 0.01}
    found = resists("thermal_drift", rate, t=[0.0, 50.0, 50.0, 50.0], dq=[2.0, 2.0, -2.0, 0.0])
    np.testing.assert_allclose(found, [0.0, 0.5 * (1.2 + 0.35), -0.5 * (1.2 + 0.35), 0.0])


def test_before_the_run_friction_is_what_the_file_has(resists):
    assert resists("thermal_drift", {"rate_1_s": 0.01}, t=-50.0) == 0.0


def test_a_joint_with_warm_friction_moves_accordingly(wheel, having, rubbing):
    arm = having(rubbing(wheel, 0.2, 0.4, 0.0), "thermal_drift", rate_1_s=0.01)
    ref = np.full((1500, 1), 0.8)
    warm = simulate(arm, ref, DT, np.zeros(1), t0_s=50.0)
    assert warm.dq.max() > 0.5
    same = simulate(rubbing(wheel, 0.3, 0.6, 0.0), ref, DT, np.zeros(1))
    np.testing.assert_allclose(warm.q, same.q, rtol=0, atol=4e-3)  # it goes on warming by 1 % in that time
    before = simulate(arm, ref, DT, np.zeros(1), t0_s=-50.0)
    cold = simulate(rubbing(wheel, 0.2, 0.4, 0.0), ref, DT, np.zeros(1))
    np.testing.assert_array_equal(before.q, cold.q)


def test_it_may_warm_or_cool(ranges):
    ranges("thermal_drift", "rate_1_s", -0.1, 0.1)
