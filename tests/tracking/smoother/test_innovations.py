"""Innovations: their likelihood is the pass's, and the filter ends where the pass ends."""

import numpy as np
import pytest

from tests.tracking.smoother.test_smoothing_pass import CASES, N, Problem
from tracking.model.expected_readings import room_of
from tracking.smoother.innovations import fill_innovations
from tracking.smoother.smoothing_pass import pass_of, smooth_once


@pytest.mark.parametrize("case", CASES)
def test_they_add_up_to_the_likelihood_of_a_pass(dd_arm, case):
    problem = Problem(dd_arm, case)
    x, P = problem.x0.copy(), problem.P0.copy()
    miss, total = np.full((2, N, problem.course.noise.size + problem.n), np.nan)
    room = room_of(problem.n)
    fill_innovations(problem.of, room, problem.course, problem.at, x, P, miss, total)
    y, Q = problem.x0.copy(), problem.P0.copy()
    found = pass_of(problem.of, problem.course, problem.size)
    cost = smooth_once(problem.of, room, problem.course, problem.at, y, Q, found, False)
    there = np.isfinite(total)
    assert not miss[~there].any() and not there[4:6].any()
    read = slice(0, problem.course.noise.size)  # a pass does not count by how much joints at rest are held to move
    squared = np.sum(miss[:, read] ** 2 / total[:, read])
    np.testing.assert_allclose(squared + np.log(total[there]).sum(), cost, rtol=1e-9)
    np.testing.assert_array_equal(x, y)
    np.testing.assert_array_equal(P, Q)
