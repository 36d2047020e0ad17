"""Trees of links: a chain is one of them, and the order of branches plays no part."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.accelerometer import specific_force
from arm.arm_file import format_arm, parse_arm
from arm.kinematics import axis_frames, link_transforms
from arm.model import Arm, Joint
from arm.moving_base import carried_inverse_dynamics, standing_base
from arm.newton_euler import forward_dynamics, inverse_dynamics, mass_matrix
from arm.outer_wrench import outer_joint_torque
from arm.regressor import regressor
from arm.simulation import simulate
from limbcal.errors import ConfigError

FEW = settings(max_examples=15, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


def everything(arm, q, dq, ddq):
    """Return what an arm's kernels make of a motion."""
    still = standing_base(len(q))
    return [
        axis_frames(arm, q),
        link_transforms(arm, q),
        mass_matrix(arm, q),
        inverse_dynamics(arm, q, dq, ddq, np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.2, 0.1])),
        forward_dynamics(arm, q, dq, ddq),
        regressor(arm, q, dq, ddq),
        specific_force(arm, q, dq, ddq),
        outer_joint_torque(arm, q, arm.n_joint, np.array([0.1, 0.2, 0.3]), np.array([3.0, 2.0, 1.0])),
        carried_inverse_dynamics(arm, q, dq, ddq, still),
        simulate(arm, q, 1e-3, q[0]).q,
    ]


@FEW
@given(SEEDS)
def test_a_chain_with_its_parents_written_out_is_the_same_chain(random_arm, random_motion, seed):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng)
    ends = [(0.0, 0.0, 0.0), *((joint.a_m, 0.0, 0.0) for joint in arm.joints)]
    named = replace(arm, joints=tuple(replace(joint, parent=i) for i, joint in enumerate(arm.joints)))
    placed = replace(
        named,
        joints=tuple(
            replace(joint, parent_position_m=end) for joint, end in zip(named.joints, ends, strict=False)
        ),
    )
    assert named.is_serial and placed.is_serial and named.parents == arm.parents
    motion = random_motion(arm, rng, 3)
    for other in (named, placed):
        for ours, theirs in zip(everything(arm, *motion), everything(other, *motion), strict=True):
            np.testing.assert_array_equal(ours, theirs)


@FEW
@given(SEEDS)
def test_the_order_of_branches_plays_no_part(random_arm, random_motion, seed):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, 7, branching=True)
    order = shuffled(arm, rng)
    other = reordered(arm, order)
    q, dq, ddq = random_motion(arm, rng, 3)
    moved = [x[:, order] for x in (q, dq, ddq)]
    n, mix = arm.n_joint, np.ix_(range(3), order, order)
    np.testing.assert_allclose(axis_frames(other, moved[0]), axis_frames(arm, q)[:, order], atol=1e-12)
    np.testing.assert_allclose(mass_matrix(other, moved[0]), mass_matrix(arm, q)[mix], rtol=0, atol=1e-10)
    tau = inverse_dynamics(arm, q, dq, ddq)
    np.testing.assert_allclose(inverse_dynamics(other, *moved), tau[:, order], rtol=0, atol=1e-9)
    columns = [*(10 * i + k for i in order for k in range(10)), *(10 * n + order), *(11 * n + order)]
    Y = regressor(arm, q, dq, ddq)[:, order][:, :, columns]
    np.testing.assert_allclose(regressor(other, *moved), Y, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        carried_inverse_dynamics(other, *moved, standing_base(3)), tau[:, order], rtol=0, atol=1e-9
    )


def shuffled(arm, rng):
    """Return an order of the joints in which parents still come first."""
    order = []
    while len(order) < arm.n_joint:
        ready = [i for i, k in enumerate(arm.parents) if i not in order and (k < 0 or k in order)]
        order.append(int(rng.choice(ready)))
    return np.array(order)


def reordered(arm, order):
    place = {-1: 0, **{int(old): new + 1 for new, old in enumerate(order)}}
    return replace(
        arm, joints=tuple(replace(arm.joints[i], parent=place[arm.parents[i]]) for i in order), sensors=()
    )


def test_joints_of_another_branch_do_not_feel_a_link(random_arm, random_motion):
    """The mass matrix has zeros, and a motion of one branch asks the other for nothing."""
    arm = random_arm(np.random.default_rng(4), 5, friction=False)
    parents = (0, 1, 2, 1, 4)
    arm = replace(
        arm,
        joints=tuple(replace(joint, parent=k) for joint, k in zip(arm.joints, parents, strict=True)),
        gravity_m_s2=(0.0, 0.0, 0.0),
    )
    assert arm.way_to(4) == (0, 3, 4) and not arm.is_serial
    q, dq, ddq = random_motion(arm, np.random.default_rng(5))
    np.testing.assert_array_equal(mass_matrix(arm, q)[:, 1:3, 3:], 0.0)
    still = np.array([0.0, 0.0, 0.0, 1.0, 1.0])
    np.testing.assert_array_equal(inverse_dynamics(arm, q, still * dq, still * ddq)[:, 1:3], 0.0)


@FEW
@given(SEEDS)
def test_a_free_tree_keeps_its_energy(random_arm, seed):
    rng = np.random.default_rng(seed)
    arm = replace(
        random_arm(rng, 4, friction=False, prismatic=False, branching=True), gravity_m_s2=(0.0, 0.0, 0.0)
    )
    q, dq = 0.3 * rng.normal(size=(2, 4))
    motion = simulate(arm, np.zeros((101, 4)), 1e-3, q, dq, torque=np.zeros((101, 4)))
    energy = np.einsum("ki,kij,kj->k", motion.dq, mass_matrix(arm, motion.q), motion.dq)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)


def test_a_tree_is_read_as_it_was_written(random_arm):
    arm = replace(random_arm(np.random.default_rng(8), 6, branching=True), name="tree")
    assert any(joint.parent_position_m for joint in arm.joints) and not arm.is_serial
    assert parse_arm(format_arm(arm), "tree.toml") == arm


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ("parent = 2", r"joint\[1\].parent is 2, expected 0 to 1, the base or an earlier link"),
        ("parent = 7", r"joint\[1\].parent is 7, expected 0 to 1, the base or an earlier link"),
        ("parent = -1", r"joint\[1\].parent is -1; input should be greater than or equal to 0"),
        ("parent = 1.0", r"joint\[1\].parent is 1.0; input should be a valid integer"),
        ("parent_position_m = [0.0, 0.1]", r"joint\[1\].parent_position_m\[2\] is missing"),
        ("parent_position_m = 0.1", r"joint\[1\].parent_position_m is 0.1; input should be a valid tuple"),
    ],
)
def test_mistakes_in_where_a_joint_hangs_are_named(fields, sentence):
    with pytest.raises(ConfigError, match="tree.toml: " + sentence):
        parse_arm(f'schema = 1\nname = "tree"\n[[joint]]\n[[joint]]\n{fields}\n', "tree.toml")


def test_the_first_joint_hangs_on_the_base():
    with pytest.raises(ConfigError, match=r"joint\[0\].parent is 1, expected 0, the base"):
        parse_arm('schema = 1\nname = "tree"\n[[joint]]\nparent = 1\n', "tree.toml")
    arm = parse_arm(
        'schema = 1\nname = "tree"\n[[joint]]\nparent = 0\nparent_position_m = [1.0, 2.0, 3.0]', "tree.toml"
    )
    np.testing.assert_array_equal(axis_frames(arm, np.zeros((1, 1)))[0, 0, :3, 3], [1.0, 2.0, 3.0])
    assert Arm("other", (Joint(),)).is_serial and not arm.is_serial
