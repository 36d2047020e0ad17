"""What a motion can reveal: the paper's eight on the DD arm, the rank of the regressor on any arm."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.base_parameters import base_parameters, with_base_values
from arm.model import Arm, Friction, Joint, Link
from arm.newton_euler import inverse_dynamics
from arm.physical_links import is_possible
from arm.regressor import regressor, standard_parameters

FEW = settings(max_examples=12, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)
EIGHT = ("I1+m2*L1^2", "m2*sx2", "m2*sy2", "I2", "D1", "D2", "fc1", "fc2")
TABLE_3 = (1.986076, 1.718632, 0.181763, 0.471209, -0.002409, 0.000311, 0.010918, -0.002271)


def link_parameters(arm):
    return standard_parameters(arm)[: 10 * arm.n_joint].reshape(-1, 10)


def test_dd_arm_has_the_eight_of_the_paper_with_the_values_of_table_3(dd_arm):
    base = base_parameters(dd_arm)
    assert base.names == EIGHT
    np.testing.assert_allclose(base.combination @ standard_parameters(dd_arm), TABLE_3, rtol=0, atol=1e-12)
    inertia, moment = "kg m^2", "kg m"
    assert base.units == (inertia, moment, moment, inertia, "N m s/rad", "N m s/rad", "N m", "N m")


def test_the_combinations_of_the_dd_arm_are_exact(dd_arm):
    base = base_parameters(dd_arm)
    expected = np.zeros((8, 24))
    columns = (2, 16, 17, 12, 20, 21, 22, 23)
    expected[range(8), columns] = 1.0
    expected[0, 19] = 0.25**2
    assert base.independent == columns
    np.testing.assert_allclose(base.combination, expected, rtol=0, atol=1e-14)


def test_hanging_the_dd_arm_adds_the_weights_of_its_first_link(vertical_arm):
    base = base_parameters(vertical_arm)
    assert base.names == ("m1*sx1+m2*L1", "m1*sy1", *EIGHT)
    values = base.combination @ standard_parameters(vertical_arm)
    np.testing.assert_allclose(values, [12.0 * 0.1 + 8.0 * 0.25, 0.0, *TABLE_3], rtol=0, atol=1e-12)


@FEW
@given(SEEDS)
def test_there_are_as_many_as_the_rank_of_the_regressor(random_arm, random_motion, seed):
    """Columns chosen one after the other span what pivoted QR and the singular values say there is."""
    rng = np.random.default_rng(seed)
    arm = random_arm(rng)
    Y = regressor(arm, *random_motion(arm, rng, 60 * arm.n_joint)).reshape(-1, 12 * arm.n_joint)
    scale = np.linalg.norm(Y, axis=0)
    Y = Y[:, scale > 1e-9 * scale.max()] / scale[scale > 1e-9 * scale.max()]
    singular = np.linalg.svd(Y, compute_uv=False)
    diagonal = np.abs(np.diag(scipy.linalg.qr(Y, mode="r", pivoting=True)[0][: Y.shape[1]]))
    n_base = len(base_parameters(arm).names)
    assert n_base == np.count_nonzero(singular > 1e-9 * singular[0])
    assert n_base == np.count_nonzero(diagonal > 1e-9 * diagonal[0])


@FEW
@given(SEEDS)
def test_base_regressor_times_base_values_is_the_torque(random_arm, random_motion, seed):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng)
    base = base_parameters(arm)
    q, dq, ddq = random_motion(arm, rng, 20)
    values = base.combination @ standard_parameters(arm)
    tau = inverse_dynamics(arm, q, dq, ddq)
    found = regressor(arm, q, dq, ddq)[..., base.independent] @ values
    np.testing.assert_allclose(found, tau, rtol=0, atol=1e-9 * max(1.0, np.abs(tau).max()))
    assert len(set(base.names)) == len(base.names)


@FEW
@given(SEEDS)
def test_an_arm_with_the_base_values_moves_the_same_and_is_possible(random_arm, random_motion, seed):
    """The values come from a possible arm, so a possible one is found, from an arm of other masses too."""
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, int(rng.integers(1, 5)))
    base = base_parameters(arm)
    values = base.combination @ standard_parameters(arm)
    other = random_arm(rng, arm.n_joint)
    wrong = replace(
        arm,
        joints=tuple(
            replace(j, link=o.link, friction=Friction()) for j, o in zip(arm.joints, other.joints, strict=True)
        ),
    )
    found = with_base_values(wrong, base, values)
    got = base.combination @ standard_parameters(found)
    np.testing.assert_allclose(got, values, rtol=0, atol=1e-9 * max(1.0, np.abs(values).max()))
    assert all(is_possible(p) for p in link_parameters(found))
    q, dq, ddq = random_motion(arm, rng, 5)
    tau = inverse_dynamics(arm, q, dq, ddq)
    np.testing.assert_allclose(
        inverse_dynamics(found, q, dq, ddq), tau, rtol=0, atol=1e-8 * max(1.0, np.abs(tau).max())
    )


def test_the_arm_itself_comes_back_from_its_own_values(dd_arm):
    base = base_parameters(dd_arm)
    found = with_base_values(dd_arm, base, np.array(TABLE_3))
    np.testing.assert_allclose(link_parameters(found), link_parameters(dd_arm), rtol=0, atol=1e-4)
    assert found.control == dd_arm.control and found.sensors == dd_arm.sensors


def test_learnt_frictions_arrive_and_static_friction_stays(dd_arm):
    stuck = replace(dd_arm.joints[0], friction=Friction(0.0, 0.0, 0.7))
    base = base_parameters(dd_arm)
    values = np.array([*TABLE_3[:4], 0.1, 0.2, 0.3, 0.4])
    found = with_base_values(replace(dd_arm, joints=(stuck, dd_arm.joints[1])), base, values)
    assert [joint.friction for joint in found.joints] == [Friction(0.1, 0.3, 0.7), Friction(0.2, 0.4, 0.0)]


def test_values_that_no_masses_can_have_are_kept_all_the_same(dd_arm):
    """A negative I2 is no arm's; the answer has the combinations, and `is_possible` says what it is."""
    base = base_parameters(dd_arm)
    values = np.array([1.9, 1.7, 0.2, -0.5, 0.0, 0.0, 0.0, 0.0])
    found = with_base_values(dd_arm, base, values)
    np.testing.assert_allclose(base.combination @ standard_parameters(found), values, rtol=0, atol=1e-9)
    assert not is_possible(link_parameters(found)[1])


def test_links_without_masses_are_no_obstacle(dd_arm):
    bare = replace(dd_arm, joints=tuple(replace(j, link=Link()) for j in dd_arm.joints))
    base = base_parameters(bare)
    assert base.names == EIGHT
    found = with_base_values(bare, base, np.array(TABLE_3))
    got = base.combination @ standard_parameters(found)
    np.testing.assert_allclose(got, TABLE_3, rtol=0, atol=1e-9)
    assert all(is_possible(p) for p in link_parameters(found))


@pytest.mark.parametrize(
    ("joint", "gravity", "names", "units"),
    [
        (Joint("revolute"), (0.0, 0.0, -9.8), ("I1", "D1", "fc1"), ("kg m^2", "N m s/rad", "N m")),
        (
            Joint("revolute"),
            (0.0, -9.8, 0.0),
            ("m1*sx1", "m1*sy1", "I1", "D1", "fc1"),
            ("kg m", "kg m", "kg m^2", "N m s/rad", "N m"),
        ),
        (Joint("prismatic"), (0.0, 0.0, -9.8), ("m1", "D1", "fc1"), ("kg", "N s/m", "N")),
    ],
)
def test_one_joint_has_what_a_pendulum_or_a_slide_has(joint, gravity, names, units):
    base = base_parameters(Arm("one", (joint,), gravity))
    assert base.names == names
    assert base.units == units


def test_the_answer_is_the_same_every_time(random_arm):
    arm = random_arm(np.random.default_rng(3), 4)
    one, two = base_parameters(arm), base_parameters(arm)
    assert one.names == two.names and one.independent == two.independent
    np.testing.assert_array_equal(one.combination, two.combination)
