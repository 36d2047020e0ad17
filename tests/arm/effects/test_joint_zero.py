"""An angle whose zero is off."""

from dataclasses import replace

import numpy as np

from arm.effects.effect_table import changed
from arm.newton_euler import inverse_dynamics


def test_a_zero_that_is_off_moves_the_link(arm, having):
    """The arm whose angles are counted from elsewhere moves alike, but for the count."""
    off = changed(having(arm, "joint_zero", joint=2, offset_rad=0.3))
    q, rng = np.full((1, 3), 0.2), np.random.default_rng(0)
    dq, ddq = rng.normal(size=(2, 1, 3))
    turned = q + [0.0, 0.3, 0.0]
    np.testing.assert_allclose(
        inverse_dynamics(off, q, dq, ddq), inverse_dynamics(arm, turned, dq, ddq), atol=1e-12
    )
    sliding = replace(arm, joints=(arm.joints[0], replace(arm.joints[1], type="prismatic"), arm.joints[2]))
    off = changed(having(sliding, "joint_zero", joint=2, offset_rad=0.3))
    np.testing.assert_allclose(
        inverse_dynamics(off, q, dq, ddq), inverse_dynamics(sliding, turned, dq, ddq), atol=1e-12
    )


def test_it_adds_to_an_offset_that_is_there(arm, having):
    twice = changed(having(having(arm, "joint_zero", offset_rad=0.3), "joint_zero", offset_rad=-0.1))
    np.testing.assert_allclose([j.theta_offset_rad for j in twice.joints], [0.2, 0.0, 0.0], atol=1e-15)


def test_it_is_half_a_turn_at_most(ranges):
    ranges("joint_zero", "offset_rad", -3.2, 3.2)
