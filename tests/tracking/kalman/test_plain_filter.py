"""The plain filter over a course with a gap, a jolt, doubted readings and rests, against filterpy's."""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from arm.model import Arm
from tests.tracking.smoother.test_smoothing_pass import DT, N, Problem, seen
from tracking.kalman.plain_filter import filter_plainly


def test_states_are_those_of_filterpy(dd_arm: Arm) -> None:
    problem = Problem(dd_arm, "plain")
    of, course, size, n = problem.of, problem.course, problem.size, problem.n
    kf = ExtendedKalmanFilter(size, course.noise.size)
    kf.x, kf.P = problem.x0.copy(), problem.P0.copy()
    offsets, right = 3 * n + np.arange(course.noise.size), []
    for k in range(N):
        if k > 0:
            kf.F, kf.Q = np.eye(size), np.zeros((size, size))
            for j in range(n):
                joint, even = slice(3 * j, 3 * j + 3), np.array([DT**2 / 6.0, DT / 2.0, 1.0])
                kf.F[joint, joint] = [[1.0, DT, DT**2 / 2.0], [0.0, 1.0, DT], [0.0, 0.0, 1.0]]
                kf.Q[joint, joint] = (course.push[j] * DT + course.jolt[k, j]) * np.outer(even, even)
            kf.Q[offsets, offsets] = course.wander * DT
            kf.x, kf.P = kf.F @ kf.x, kf.F @ kf.P @ kf.F.T + kf.Q
        if course.present[k]:
            R = np.diag(course.noise * course.doubt[k])
            kf.update(course.readings[k], lambda x: seen(of, x)[1], lambda x: seen(of, x)[0], R=R)
        for j in np.flatnonzero(course.rest[k]):
            h = np.eye(size)[None, 3 * j + 1]
            K = kf.P @ h.T / (h @ kf.P @ h.T + course.rest[k, j])
            kf.x, kf.P = kf.x - K[:, 0] * kf.x[3 * j + 1], kf.P - K @ h @ kf.P
        right.append(kf.x.copy())
    x, P = problem.x0.copy(), problem.P0.copy()
    np.testing.assert_allclose(filter_plainly(of, course, x, P), right, rtol=1e-6, atol=1e-8)
    np.testing.assert_array_equal(x, problem.x0)
    np.testing.assert_array_equal(P, problem.P0)
