"""A recording linearised along a motion: it is smoothed as a pass smooths, and stays as it was."""

import numpy as np

from tests.tracking.smoother.test_smoothing_pass import Problem
from tracking.smoother.linearised import Linearised
from tracking.smoother.smoothing_pass import pass_of, smooth_once


def test_it_is_smoothed_by_one_pass(dd_arm):
    one = Problem(dd_arm, "discrepancy")
    problem = Linearised(one.of, one.course, one.at, one.x0.copy(), one.P0.copy())
    found, x, P = problem.smoothed()
    y, Q, plain = one.x0.copy(), one.P0.copy(), pass_of(one.of, one.course, one.size)
    smooth_once(one.of, problem.room, one.course, one.at, y, Q, plain, True)
    np.testing.assert_array_equal(found.states, plain.states)
    np.testing.assert_array_equal(x, y)
    np.testing.assert_array_equal(P, Q)
    np.testing.assert_array_equal(problem.x0, one.x0)
    np.testing.assert_array_equal(problem.P0, one.P0)
    assert problem.angles_of(found).shape == problem.angle_variance_of(found).shape == (len(one.at), one.n)
    np.testing.assert_array_equal(problem.angles_of(found)[:, 1], plain.states[:, 3])
    np.testing.assert_array_equal(problem.angle_variance_of(found)[:, 1], found.variance[:, 3])
