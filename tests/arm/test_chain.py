"""What kernels are given: the arm's numbers, and rows of equal length."""

import numpy as np
import pytest

from arm.chain import chain_of, hang_on, joint_rows, link_step, motion_rows, move, poses
from arm.model import Arm, Joint
from limbcal.errors import DataError


def test_the_papers_rho_is_true_where_a_joint_turns():
    chain = chain_of(Arm("two", (Joint("prismatic"), Joint("revolute"))))
    assert chain.revolute.tolist() == [False, True]


def test_numbers_are_where_kernels_look_for_them(dd_arm):
    chain = chain_of(dd_arm)
    assert chain.geometry[1].tolist() == [0.0, 0.3, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(chain.inertial[1, 6:], [1.718632, 0.181763, 0.0, 8.0], rtol=1e-14)
    assert chain.friction[0].tolist() == [-0.002409, 0.010918, 0.0]


def test_rows_are_contiguous_whatever_they_came_as(dd_arm):
    rows = joint_rows(dd_arm, "q", np.asfortranarray(np.arange(10.0).reshape(5, 2)))
    assert rows.flags.c_contiguous and rows.shape == (5, 2)
    assert joint_rows(dd_arm, "q", [1, 2]).tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize("shape", [(), (3,), (4, 1), (2, 2, 2)])
def test_other_shapes_are_named(dd_arm, shape):
    with pytest.raises(DataError, match=r"q has shape \(.*\), expected \(n_sample, 2\)"):
        joint_rows(dd_arm, "q", np.zeros(shape))


def test_kernels_never_read_beyond_the_shorter_of_two_arrays(dd_arm):
    assert [rows.shape for rows in motion_rows(dd_arm, q=np.zeros((3, 2)), dq=np.zeros((3, 2)))] == [(3, 2)] * 2
    with pytest.raises(DataError, match="dq has 2 samples and q has 3; expected as many"):
        motion_rows(dd_arm, q=np.zeros((3, 2)), dq=np.zeros((2, 2)))


@pytest.mark.parametrize("seed", range(5))
def test_poses_are_those_of_eq_1(random_arm, seed):
    """Along a motion, too, of whose poses only what changes is filled in."""
    rng = np.random.default_rng(seed)
    chain = chain_of(random_arm(rng, branching=True))
    n = len(chain.revolute)
    expected, whole, kept = (
        [np.empty((n, 3, 3)), np.empty((n, 3))],
        [np.empty((n, 3, 3)), np.empty((n, 3))],
        [chain.zero_R.copy(), chain.zero_p.copy()],
    )
    for q in rng.normal(size=(3, n)):
        for i in range(n):
            alpha, _, d, beta, offset = chain.geometry[i]
            link_step(chain.revolute[i], alpha, d, beta, offset, q[i], expected[0][i], expected[1][i])
            hang_on(chain.geometry, chain.parent, chain.hang, i, expected[1][i])
        poses(chain, q, *whole)
        move(chain, q, np.cos(q), np.sin(q), *kept)
        for found in (whole, kept):
            for one, other in zip(found, expected, strict=True):
                np.testing.assert_allclose(one, other, rtol=0, atol=1e-14)
