"""The response to errors, against differences of smoothed motions and in a world shifted as a whole."""

import numpy as np
import pytest

from arm.model import Arm
from tests.tracking.smoother.test_smoothing_pass import DT, Problem, seen
from tracking.kalman.kalman_step import predict
from tracking.model.expected_readings import room_of
from tracking.smoother.linear_response import respond
from tracking.smoother.smoothing_pass import STRETCH, pass_of, smooth_once

EXACT = ["plain", "AC-coupled", "mountings", "gyroscopes"]
KINDS = [*EXACT, "discrepancy"]
DRAWS = 3


def long(problem: Problem, times: int) -> Problem:
    """Return the problem with its course so many times over."""
    course = problem.course
    names = ("readings", "present", "jolt", "doubt", "rest")
    fields = {name: np.concatenate([getattr(course, name)] * times) for name in names}
    problem.course, problem.at = course._replace(**fields), np.concatenate([problem.at] * times)
    return problem


def smoothed(problem: Problem, x0: np.ndarray, readings: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the motion, and state and covariance at its end."""
    course, x, P = problem.course._replace(readings=readings), x0.copy(), problem.P0.copy()
    found = pass_of(problem.of, course, problem.size)
    smooth_once(problem.of, room_of(problem.n), course, problem.at, x, P, found, False)
    return found.states, x, P


def response(problem: Problem, errors: np.ndarray, noise: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the errors of all instants, and errors and covariance at the end."""
    after, P = errors.copy(), problem.P0.copy()
    every = np.empty((len(problem.at), problem.size, errors.shape[1]))
    respond(problem.of, room_of(problem.n), problem.course, problem.at, P, after, noise, every)
    return every, after, P


def drawn(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Return errors of what was known before, and of readings; joints at rest have no speed."""
    rng, n_channel = np.random.default_rng(5), problem.course.noise.size
    noise = np.zeros((len(problem.at), n_channel + problem.n, DRAWS))
    noise[:, :n_channel] = 0.03 * rng.normal(size=(len(problem.at), n_channel, DRAWS))
    noise[~problem.course.present] = 0.0
    return np.linalg.cholesky(problem.P0) @ rng.normal(size=(problem.size, DRAWS)), noise


@pytest.mark.parametrize("times", [1, 11], ids=["in one stretch", "beyond a stretch"])
@pytest.mark.parametrize("kind", KINDS)
def test_it_is_the_difference_of_smoothed_motions(dd_arm: Arm, kind: str, times: int) -> None:
    problem = long(Problem(dd_arm, kind), times)
    assert (len(problem.at) > STRETCH) == (times > 1)
    errors, noise = drawn(problem)
    every, after, P = response(problem, errors, noise)
    n_channel = problem.course.noise.size
    states, x, right_P = smoothed(problem, problem.x0, problem.course.readings)
    np.testing.assert_allclose(P, right_P, rtol=1e-9, atol=1e-15)
    for d in range(DRAWS):
        readings = problem.course.readings + noise[:, :n_channel, d]
        other, other_x, _ = smoothed(problem, problem.x0 + errors[:, d], readings)
        scale = 1e-6 * np.abs(other - states).max(axis=0)
        assert (np.abs(every[:, :, d] - (other - states)) <= scale + 1e-10).all()
        np.testing.assert_allclose(after[:, d], other_x - x, rtol=1e-6, atol=1e-9)


def test_only_the_first_entries_of_each_state_may_be_asked_for(dd_arm: Arm) -> None:
    problem = Problem(dd_arm, "plain")
    errors, noise = drawn(problem)
    whole, _, _ = response(problem, errors, noise)
    part = np.empty((len(problem.at), 6, DRAWS))
    respond(problem.of, room_of(2), problem.course, problem.at, problem.P0.copy(), errors, noise, part)
    np.testing.assert_array_equal(part, whole[:, :6])


def sought_corners(arm: Arm) -> Problem:
    """Return a course of AC-coupled sensors, corners sought, in which every reading is what is predicted."""
    problem = Problem(arm, "AC-coupled, sought", eventful=False)
    of, course, x = problem.of, problem.course, problem.x0.copy()
    nothing = np.zeros((problem.size, problem.size))
    for k in range(len(problem.at)):
        before = x.copy()
        for _ in range(30):  # what is forgotten depends on the reading, and that on what is forgotten
            x = before.copy()
            if k > 0:
                predict(of, course, k, x, nothing.copy())
            course.readings[k] = seen(of, x)[0]
        problem.at[k] = x
    return problem


def test_a_corner_in_error_moves_what_is_forgotten(dd_arm: Arm) -> None:
    problem = sought_corners(dd_arm)
    errors, noise = drawn(problem)
    every, _, _ = response(problem, errors, noise)
    n_channel, h = problem.course.noise.size, 1e-4
    for d in range(DRAWS):
        both = [
            smoothed(problem, problem.x0 + s * errors[:, d], problem.course.readings + s * noise[:, :n_channel, d])
            for s in (h, -h)
        ]
        slope = (both[0][0] - both[1][0]) / (2.0 * h)
        assert (np.abs(every[:, :, d] - slope) <= 1e-4 * np.abs(slope).max(axis=0)).all()


@pytest.mark.parametrize("kind", EXACT)
def test_a_world_that_is_shifted_as_a_whole_is_found_shifted(dd_arm: Arm, kind: str) -> None:
    """Readings and speeds at rest that go with a wrong beginning leave it as wrong as it was."""
    problem = Problem(dd_arm, kind)
    problem.course.present[:] = True
    of, n, n_channel = problem.of, problem.n, problem.course.noise.size
    shift = np.linalg.cholesky(problem.P0) @ np.random.default_rng(6).normal(size=(problem.size, 1))
    right, noise, corner = [], np.zeros((len(problem.at), n_channel + n, 1)), np.repeat(of.corner, 3)
    settled = [of.settled_column[c // 3] + c % 3 for c in range(n_channel)]
    errors, offsets = shift.copy(), slice(3 * n, 3 * n + n_channel)
    for k, at in enumerate(problem.at):
        H = seen(of, at)[1]
        if k > 0:
            for j in range(n):
                F = np.array([[1.0, DT, DT**2 / 2.0], [0.0, 1.0, DT], [0.0, 0.0, 1.0]])
                shift[3 * j : 3 * j + 3] = F @ shift[3 * j : 3 * j + 3]
            before, level = noise[k - 1, :n_channel], shift[settled] * (corner > 0.0)[:, None]
            rest = H @ shift - shift[offsets]  # the reading is this and its offset, which the reading moves
            keep = 0.5 * DT * corner[:, None]
            moved = shift[offsets] - keep * (before + rest - 2.0 * level)
            shift[offsets] = moved / (1.0 + keep)
        noise[k, :n_channel], noise[k, n_channel:] = H @ shift, shift[1 : 3 * n : 3]
        right.append(shift.copy())
    every, after, _ = response(problem, errors, noise)
    np.testing.assert_allclose(every, right, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(after, shift, rtol=1e-6, atol=1e-9)
