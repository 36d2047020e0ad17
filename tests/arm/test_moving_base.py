"""Inverse dynamics on a base that moves: against the arm's own recursion at rest, and against pinocchio."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from arm.kinematics import axis_frames
from arm.moving_base import BaseState, OuterWrench, carried_inverse_dynamics, standing_base
from arm.outer_wrench import touched_inverse_dynamics
from limbcal.errors import DataError

FEW = settings(max_examples=25, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


@FEW
@given(SEEDS, st.booleans())
def test_on_a_base_at_rest_it_is_the_plain_recursion(random_arm, random_motion, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = random_motion(arm, rng)
    joint = int(rng.integers(1, arm.n_joint + 1))
    force, moment = rng.normal(scale=10.0, size=(2, len(q), 3))

    at = axis_frames(arm, q)[:, joint - 1, :3, 3]
    expected = touched_inverse_dynamics(arm, q, dq, ddq, joint, np.zeros(3), force, moment)
    found = carried_inverse_dynamics(
        arm, q, dq, ddq, standing_base(len(q)), [OuterWrench(joint, at, force, moment)]
    )
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * max(1.0, np.abs(expected).max()))


@FEW
@given(SEEDS, st.booleans())
def test_on_a_base_that_moves_it_is_pinocchios_floating_base(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = random_motion(arm, rng)
    n = len(q)
    R = Rotation.random(n, rng).as_matrix()
    omega, omega_dot, v, acceleration, p = rng.normal(size=(5, n, 3))
    joint = int(rng.integers(1, arm.n_joint + 1))
    force, moment, at = rng.normal(scale=10.0, size=(3, n, 3))
    found = carried_inverse_dynamics(
        arm, q, dq, ddq, BaseState(R, p, omega, omega_dot, acceleration), [OuterWrench(joint, at, force, moment)]
    )
    other = peer(arm)
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    for i in range(1, other.model.njoints):
        parent = other.model.parents[i] + 1 if other.model.parents[i] else root
        kind = pin.JointModelRZ() if arm.joints[i - 1].type == "revolute" else pin.JointModelPZ()
        k = model.addJoint(parent, kind, other.model.jointPlacements[i], f"j{i}")
        model.appendBodyToJoint(k, other.model.inertias[i], pin.SE3.Identity())
    model.gravity.linear = np.array(arm.gravity_m_s2)
    data = model.createData()
    for k in range(n):
        place = np.concatenate([p[k], Rotation.from_matrix(R[k]).as_quat()])
        own = R[k].T
        # pinocchio's free flyer has its velocity in its own axes, and there the derivative of v is a - w x v
        rate = np.concatenate([own @ v[k], own @ omega[k], dq[k]])
        spatial = own @ (acceleration[k] - np.cross(omega[k], v[k]))
        second = np.concatenate([spatial, own @ omega_dot[k], ddq[k]])
        configuration = np.concatenate([place, q[k]])
        pin.forwardKinematics(model, data, configuration)
        loads = pin.StdVec_Force([pin.Force.Zero() for _ in range(model.njoints)])
        world = pin.SE3(np.eye(3), at[k])
        loads[joint + 1] = data.oMi[joint + 1].actInv(world.act(pin.Force(force[k], moment[k])))
        expected = pin.rnea(model, data, configuration, rate, second, loads)[6:] + other.friction(dq[k])
        np.testing.assert_allclose(found[k], expected, rtol=0, atol=1e-9 * max(1.0, np.abs(expected).max()))


def test_a_falling_arm_needs_no_torque(random_arm, random_motion):
    rng = np.random.default_rng(3)
    arm = random_arm(rng, friction=False)
    q, dq, _ = random_motion(arm, rng)
    base = standing_base(len(q))
    falling = BaseState(base.R, base.p, base.omega, base.omega_dot, np.tile(arm.gravity_m_s2, (len(q), 1)))
    found = carried_inverse_dynamics(arm, q, 0.0 * dq, 0.0 * dq, falling)
    np.testing.assert_allclose(found, 0.0, atol=1e-12)


def test_what_does_not_fit_is_said(random_arm, random_motion):
    rng = np.random.default_rng(4)
    arm = random_arm(rng, 2)
    q, dq, ddq = random_motion(arm, rng)
    with pytest.raises(DataError, match="as many"):
        carried_inverse_dynamics(arm, q, dq, ddq, standing_base(3))
    nothing = np.zeros((len(q), 3))
    with pytest.raises(DataError, match="expected one of 1 to 2"):
        carried_inverse_dynamics(
            arm, q, dq, ddq, standing_base(len(q)), [OuterWrench(3, nothing, nothing, nothing)]
        )
