"""What a rest cannot change, by arms whose readings at rest are known."""

from dataclasses import replace

import numpy as np

from arm.accelerometer import specific_force
from tracking.dead_reckoning.integration_state import reckoning_of
from tracking.dead_reckoning.rest_contrasts import contrasts, gravity_slack


def test_sensors_of_a_link_read_the_same_at_any_rest(upright_bench):
    """By the forward model, in other poses than the one that the contrasts were made in."""
    arm = upright_bench.arm
    found = contrasts(reckoning_of(arm, np.zeros(arm.n_joint)))
    assert found.shape == (3 * arm.n_joint, 3 * len(arm.sensors))
    q = np.random.default_rng(1).uniform(-2.0, 2.0, (20, arm.n_joint))
    felt = specific_force(arm, q, np.zeros_like(q), np.zeros_like(q)).reshape(20, -1)
    np.testing.assert_allclose(felt @ found.T, 0.0, atol=1e-12)
    assert np.abs(felt).max() > 5.0


def test_a_drift_of_two_degrees_changes_no_reading_by_more(upright_bench):
    arm, rng = upright_bench.arm, np.random.default_rng(2)
    slack = gravity_slack(arm, reckoning_of(arm, np.zeros(arm.n_joint)))
    q = rng.uniform(-2.0, 2.0, (50, arm.n_joint))
    drift = np.deg2rad(2.0) * rng.uniform(-1.0, 1.0, q.shape)
    before, after = (
        specific_force(arm, one, np.zeros_like(q), np.zeros_like(q)).reshape(50, -1) for one in (q, q + drift)
    )
    most = np.abs(after - before).max(axis=0)
    assert (most <= slack + 1e-12).all()
    assert most.max() > 0.1


def test_gravity_shows_no_angle_of_a_level_arm(dd_arm):
    level = replace(dd_arm, gravity_m_s2=(0.0, 0.0, -9.80665))
    np.testing.assert_allclose(gravity_slack(level, reckoning_of(level, np.zeros(2))), 0.0, atol=1e-12)
