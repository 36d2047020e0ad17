"""Which joints of a resting arm let go: each must obey its friction, all at once."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.model import Friction
from arm.newton_euler import bias_torque, mass_matrix
from arm.simulation import simulate

FEW = settings(max_examples=200, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


def at_rest(arm, torque, q):
    """Return the accelerations of a resting arm under a torque, and what friction does in each joint."""
    ddq = simulate(arm, np.zeros((1, arm.n_joint)), 1e-3, q, torque=torque[None]).ddq[0]
    friction = torque - bias_torque(arm, q, np.zeros(arm.n_joint))[0] - mass_matrix(arm, q)[0] @ ddq
    return ddq, friction


@FEW
@given(SEEDS, st.booleans())
def test_every_joint_obeys_its_friction(random_arm, seed, grips_harder_at_rest):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, int(rng.integers(2, 6)))
    coulomb = rng.uniform(0.0, 8.0, arm.n_joint)
    static = coulomb * rng.uniform(1.0, 2.0, arm.n_joint) if grips_harder_at_rest else 0.0 * coulomb
    arm = replace(
        arm,
        joints=tuple(
            replace(joint, friction=Friction(0.1, float(coulomb[i]), float(static[i])))
            for i, joint in enumerate(arm.joints)
        ),
    )
    q = rng.uniform(-np.pi, np.pi, arm.n_joint)
    torque = bias_torque(arm, q, np.zeros(arm.n_joint))[0] + rng.normal(scale=8.0, size=arm.n_joint)
    ddq, friction = at_rest(arm, torque, q)
    stuck = ddq == 0.0  # to the last bit
    assert np.all(np.abs(friction[stuck]) <= np.maximum(coulomb, static)[stuck] + 1e-9)
    np.testing.assert_allclose(friction[~stuck], (coulomb * np.sign(ddq))[~stuck], rtol=0, atol=1e-8)


def test_a_joint_that_is_dragged_along_against_its_own_torque(random_arm):
    """One joint let go may turn another one round: then friction must turn with it, or hold it."""
    turned = 0
    for seed in range(300):
        rng = np.random.default_rng(seed)
        arm = random_arm(rng, 3, friction=False)
        arm = replace(arm, joints=tuple(replace(j, friction=Friction(0.0, 2.0, 2.0)) for j in arm.joints))
        q, push = rng.uniform(-np.pi, np.pi, 3), rng.normal(scale=8.0, size=3)
        ddq, _ = at_rest(arm, bias_torque(arm, q, np.zeros(3))[0] + push, q)
        turned += np.count_nonzero((np.abs(push) > 2.0) & (push * ddq <= 0.0))
    assert turned > 20  # the case is no rarity


def test_a_stuck_joint_does_not_creep_while_another_moves(dd_arm):
    """Masses beyond 1 kg m^2 make elimination pivot; the held joint's zero must survive that."""
    heavy = replace(dd_arm.joints[1].link, mass_kg=800.0, inertia_kg_m2=(2.5, 46.0, 47.1, -3.9, 0.0, 0.0))
    first = replace(dd_arm.joints[0], friction=Friction(0.0, 1000.0, 1000.0))
    arm = replace(dd_arm, joints=(first, replace(dd_arm.joints[1], link=heavy)))
    motion = simulate(arm, np.tile([0.0, 1.0], (1000, 1)), 1e-3, np.array([0.1, 0.2]))
    np.testing.assert_array_equal(motion.q[:, 0], 0.1)
    assert motion.q[-1, 1] > 0.25


@pytest.mark.parametrize("scheme", ["rk4", "paper"])
def test_an_unloaded_joint_with_friction_that_pushes_stays(dd_arm, scheme):
    """The "true" fc2 is negative. With nothing to choose a direction, the joint stays where it is."""
    motion = simulate(dd_arm, np.zeros((100, 2)), 1e-3, np.zeros(2), scheme=scheme)
    np.testing.assert_array_equal(motion.q, 0.0)
