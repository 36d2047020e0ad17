"""The torque is linear in the parameters, with the columns that pinocchio has."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.model import Friction, Link
from arm.newton_euler import inverse_dynamics
from arm.regressor import regressor, standard_names, standard_parameters
from limbcal.errors import DataError

FEW = settings(max_examples=40, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)
#: Where xx yy zz xy xz yz, m*sx m*sy m*sz, m are among pinocchio's m, m*s, xx xy yy xz yz zz.
PINOCCHIOS = [4, 6, 9, 5, 7, 8, 1, 2, 3, 0]


@FEW
@given(SEEDS, st.booleans())
def test_regressor_times_parameters_is_the_torque(random_arm, random_motion, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = random_motion(arm, rng)
    dq[0] = 0.0  # a joint at rest shows no Coulomb friction here either
    tau = inverse_dynamics(arm, q, dq, ddq)
    found = regressor(arm, q, dq, ddq) @ standard_parameters(arm)
    np.testing.assert_allclose(found, tau, rtol=0, atol=1e-9 * max(1.0, np.abs(tau).max()))


@FEW
@given(SEEDS, st.booleans())
def test_regressor_is_pinocchios(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = random_motion(arm, rng)
    other = peer(arm)
    Y = regressor(arm, q, dq, ddq)
    n = arm.n_joint
    for k in range(len(q)):
        theirs = pin.computeJointTorqueRegressor(other.model, other.data, q[k], dq[k], ddq[k])
        theirs = theirs.reshape(n, n, 10)[:, :, PINOCCHIOS].reshape(n, 10 * n)
        np.testing.assert_allclose(Y[k, :, : 10 * n], theirs, rtol=0, atol=1e-9 * max(1.0, np.abs(theirs).max()))
        np.testing.assert_array_equal(Y[k, :, 10 * n : 11 * n], np.diag(dq[k]))
        np.testing.assert_array_equal(Y[k, :, 11 * n :], np.diag(np.sign(dq[k])))


@FEW
@given(SEEDS, st.booleans())
def test_parameters_are_pinocchios(random_arm, peer, seed, branching):
    arm = random_arm(np.random.default_rng(seed), branching=branching)
    model = peer(arm).model
    theirs = [model.inertias[i + 1].toDynamicParameters()[PINOCCHIOS] for i in range(arm.n_joint)]
    ours = standard_parameters(arm)[: 10 * arm.n_joint]
    np.testing.assert_allclose(ours, np.concatenate(theirs), rtol=0, atol=1e-12)


def test_names_say_the_order(dd_arm):
    names, values = standard_names(2), standard_parameters(dd_arm)
    assert len(names) == len(values) == 24
    known = dict(zip(names, values, strict=True))
    assert names[:10] == ["I1xx", "I1yy", "I1zz", "I1xy", "I1xz", "I1yz", "m1*sx1", "m1*sy1", "m1*sz1", "m1"]
    assert names[20:] == ["D1", "D2", "fc1", "fc2"]
    assert known["m2*sx2"] == pytest.approx(1.718632) and known["fc2"] == -0.002271 and known["I2xy"] == -0.039


def test_the_arms_own_masses_play_no_part(dd_arm, random_motion):
    q, dq, ddq = random_motion(dd_arm, np.random.default_rng(0))
    bare = replace(dd_arm, joints=tuple(replace(j, link=Link(), friction=Friction()) for j in dd_arm.joints))
    np.testing.assert_array_equal(regressor(bare, q, dq, ddq), regressor(dd_arm, q, dq, ddq))


def test_wrong_shapes_are_named(dd_arm):
    with pytest.raises(DataError, match=r"q has shape \(2, 1\), expected \(n_sample, 2\)"):
        regressor(dd_arm, np.zeros((2, 1)), np.zeros((2, 2)), np.zeros((2, 2)))
    with pytest.raises(DataError, match="ddq has 1 samples and q has 2; expected as many"):
        regressor(dd_arm, np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((1, 2)))
