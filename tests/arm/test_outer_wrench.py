"""A force and moment at any point of any link: against pinocchio, against ``J^T``, against a case by hand."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.chain import chain_of, poses
from arm.kinematics import axis_frames
from arm.newton_euler import inverse_dynamics
from arm.outer_wrench import outer_joint_torque, point_motion, touched_forward_dynamics, touched_inverse_dynamics
from limbcal.errors import DataError
from tests.arm.closeness import close

FEW = settings(max_examples=40, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


def draw(random_arm, rng, branching, n_joint=None):
    arm = random_arm(rng, n_joint, branching=branching)
    return arm, int(rng.integers(1, arm.n_joint + 1)), rng.uniform(-0.4, 0.4, 3)


@FEW
@given(SEEDS, st.booleans())
def test_touched_anywhere_it_moves_as_pinocchios(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm, joint, point = draw(random_arm, rng, branching, 7)
    q, dq, ddq = random_motion(arm, rng)
    force, moment = rng.normal(scale=10.0, size=(2, len(q), 3))
    other = peer(arm)
    tau = touched_inverse_dynamics(arm, q, dq, ddq, joint, point, force, moment)
    pushed = touched_forward_dynamics(arm, q, dq, 10.0 * tau, joint, point, force, moment)
    for k in range(len(q)):
        pin.forwardKinematics(other.model, other.data, q[k])
        link = other.data.oMi[joint]
        at = pin.SE3(np.eye(3), link.act(point))
        loads = pin.StdVec_Force([pin.Force.Zero() for _ in range(other.model.njoints)])
        loads[joint] = link.actInv(at.act(pin.Force(force[k], moment[k])))
        drag = other.friction(dq[k])
        close(tau[k], pin.rnea(other.model, other.data, q[k], dq[k], ddq[k], loads) + drag)
        close(pushed[k], pin.aba(other.model, other.data, q[k], dq[k], 10.0 * tau[k] - drag, loads))


@FEW
@given(SEEDS, st.booleans())
def test_it_is_the_transposed_jacobian(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm, joint, point = draw(random_arm, rng, branching)
    q, _, _ = random_motion(arm, rng, 1)
    force, moment = rng.normal(size=(2, 3))
    other = peer(arm)
    frame = other.model.addFrame(pin.Frame("touched", joint, 0, pin.SE3(np.eye(3), point), pin.FrameType.OP_FRAME))
    data = other.model.createData()
    J = pin.computeFrameJacobian(other.model, data, q[0], frame, pin.LOCAL_WORLD_ALIGNED)
    close(outer_joint_torque(arm, q, joint, point, force, moment)[0], J.T @ np.concatenate([force, moment]))


@FEW
@given(SEEDS, st.booleans())
def test_a_point_is_and_moves_where_its_link_takes_it(random_arm, random_motion, seed, branching):
    rng = np.random.default_rng(seed)
    arm, joint, point = draw(random_arm, rng, branching)
    q, dq, _ = random_motion(arm, rng, 1)
    n, h = arm.n_joint, 1e-6
    R, p, axes, moving = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((3, 3)), np.empty((3, 3))
    poses(chain_of(arm), q[0], R, p)
    point_motion(chain_of(arm), R, p, dq[0], joint - 1, point, axes, moving)
    before, now, after = axis_frames(arm, np.vstack([q - h * dq, q, q + h * dq]))[:, joint - 1]
    close(axes, now[:3, :3], 1e-12)
    close(moving[0], now[:3, :3] @ point + now[:3, 3], 1e-12)
    close(moving[1], (after - before)[:3] @ [*point, 1.0] / (2.0 * h), 1e-7)
    spin = (after - before)[:3, :3] / (2.0 * h) @ now[:3, :3].T
    close(moving[2], [spin[2, 1], spin[0, 2], spin[1, 0]], 1e-7)


def test_at_the_tip_it_is_the_tips_force(random_arm, random_motion):
    rng = np.random.default_rng(3)
    arm = random_arm(rng, 5)
    q, dq, ddq = random_motion(arm, rng)
    force, moment = rng.normal(size=(2, len(q), 3))
    tip = np.array([arm.joints[-1].a_m, 0.0, 0.0])
    close(
        touched_inverse_dynamics(arm, q, dq, ddq, 5, tip, force, moment),
        inverse_dynamics(arm, q, dq, ddq, force, moment),
    )


def test_an_arm_at_rest_is_pushed_at_its_tip(dd_arm):
    """The Jacobian of two links in a plane, by hand."""
    q = np.array([[0.4, -0.9]])
    force = np.array([3.0, -7.0, 11.0])
    a, b = 0.25, 0.3
    s1, c1, s12, c12 = np.sin(0.4), np.cos(0.4), np.sin(-0.5), np.cos(-0.5)
    J = np.array([[-a * s1 - b * s12, -b * s12], [a * c1 + b * c12, b * c12], [0.0, 0.0]])
    found = touched_inverse_dynamics(dd_arm, q, 0 * q, 0 * q, 2, np.array([b, 0.0, 0.0]), force)
    np.testing.assert_allclose(found[0], -J.T @ force, rtol=0, atol=1e-12)


def test_what_does_not_fit_is_refused(dd_arm):
    q, tip = np.zeros((2, 2)), np.zeros(3)
    with pytest.raises(DataError, match="joint is 3, expected one of 1 to 2"):
        outer_joint_torque(dd_arm, q, 3, tip, tip)
    with pytest.raises(DataError, match="point_m has shape"):
        outer_joint_torque(dd_arm, q, 1, np.zeros(2), tip)
    with pytest.raises(DataError, match=r"force has shape \(3, 3\)"):
        outer_joint_torque(dd_arm, q, 1, tip, np.zeros((3, 3)))
