"""What kernels are given: the arm's numbers, and rows of equal length."""

import numpy as np
import pytest

from arm.chain import chain_of, joint_rows, motion_rows
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
