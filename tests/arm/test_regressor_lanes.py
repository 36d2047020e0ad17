"""Samples side by side are what each is alone, to the last bit, whatever their number."""

import numpy as np
import pytest

from arm.newton_euler import inverse_dynamics
from arm.regressor import regressor, standard_parameters
from arm.regressor_lanes import LANES
from tests.arm.conftest import draw_arm


@pytest.mark.parametrize("n_sample", [1, LANES - 1, LANES, LANES + 1, 3 * LANES + 5])
def test_a_sample_has_the_same_rows_beside_others_as_alone(n_sample):
    rng = np.random.default_rng(n_sample)
    arm = draw_arm(rng, 6, branching=True)
    q, dq, ddq = rng.normal(size=(3, n_sample, arm.n_joint))
    together = regressor(arm, q, dq, ddq)
    for k in range(n_sample):
        np.testing.assert_array_equal(together[k], regressor(arm, q[k : k + 1], dq[k : k + 1], ddq[k : k + 1])[0])


def test_a_tree_of_thirty_joints_has_the_torques_of_newton_euler():
    rng = np.random.default_rng(0)
    arm = draw_arm(rng, 30, branching=True)
    q, dq, ddq = rng.normal(size=(3, LANES + 3, 30))
    torque = regressor(arm, q, dq, ddq) @ standard_parameters(arm)
    np.testing.assert_allclose(torque, inverse_dynamics(arm, q, dq, ddq), rtol=1e-10, atol=1e-10)


def test_no_samples_have_no_rows():
    arm = draw_arm(np.random.default_rng(1), 3)
    none = np.zeros((0, 3))
    assert regressor(arm, none, none, none).shape == (0, 3, 36)
