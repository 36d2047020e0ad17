"""The filter over a whole recording: its answer, and the rests, jolts and doubts that it finds."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.model import Arm
from tests.tracking.smoother.test_smoothing_pass import N, Problem, assert_close, seen
from tracking.kalman.forward_filter import filter_all, first_window, gather, jolt_of, take_again
from tracking.kalman.kalman_step import correct, hold, predict, room_to_take
from tracking.model.course import Course
from tracking.model.expected_readings import room_of
from tracking.model.observation import observation_of
from tracking.model.process_noise import alarm_limit
from tracking.model.zero_velocity import rest_variance, unrest, window_of

SIGMA, CELL, N_CELL, REST = 0.02, 2, 4, 40
LIMIT = alarm_limit(12)
POSE = np.array([0.4, -0.3])


class Resting:
    """An arm at rest, its readings, and the filter over them."""

    def __init__(self, arm: Arm) -> None:
        self.arm, (self.of, self.size) = arm, observation_of(arm)
        still, rng = np.zeros((1, 2)), np.random.default_rng(0)
        level = specific_force(arm, POSE[None], still, still).ravel()
        values = level + SIGMA * rng.standard_normal((REST, 12))
        self.course = Course(
            0.01,
            values,
            np.ones(REST, dtype=np.bool_),
            np.full(12, SIGMA**2),
            np.full(12, 1e-9),
            np.full(2, 9.0),
            np.zeros((REST, 2)),
            np.ones((REST, 12)),
            np.zeros((REST, 2)),
            np.zeros(2),
        )
        self.x, std = np.zeros(self.size), np.full(self.size, 1e-3)
        self.x[[0, 3]] = POSE
        std[[1, 2, 4, 5]] = 1e-4, 1e-3, 1e-4, 1e-3
        self.P = np.diag(std**2)

    def filtered(self) -> None:
        self.window = window_of(N_CELL, self.size, self.course.noise / CELL, np.zeros(12))
        self.states = np.empty((len(self.course.readings), self.size))
        self.still, self.resting = np.ones((2, len(self.states)), dtype=np.bool_)
        filter_all(
            self.of,
            room_of(2),
            self.course,
            self.window,
            CELL,
            LIMIT,
            self.x.copy(),
            self.P.copy(),
            self.states,
            self.still,
            self.resting,
        )


def test_it_ends_at_the_dense_solution(dd_arm: Arm) -> None:
    """Each reading is linearised where it is predicted; linearised there, the dense problem has the same end."""
    problem = Problem(dd_arm, "plain", eventful=False)
    of, course, n = problem.of, problem.course, problem.n
    at = np.empty((N, problem.size))
    x, P = problem.x0.copy(), problem.P0.copy()
    room, taken = room_of(n), room_to_take(course, problem.size, 1)[0]
    for k in range(N):
        if k > 0:
            predict(of, course, k, x, P)
        at[k] = x
        correct(of, room, course, k, at[k], x, P, taken)
        hold(course, k, x, P, taken)
    problem.at = at
    states, covariance = problem.dense()
    found = np.empty((N, problem.size))
    still, resting = np.zeros((2, N), dtype=np.bool_)
    window = window_of(25, problem.size, course.noise, np.zeros_like(course.noise))
    x, P, limit = problem.x0.copy(), problem.P0.copy(), 1e4 * LIMIT  # a miss is just a miss
    filter_all(of, room, course, window, 1, limit, x, P, found, still, resting)
    assert_close(found[-1], states[-1], covariance[-1])
    np.testing.assert_array_equal(course.jolt, 0.0)


def test_an_arm_at_rest_is_held_from_its_first_reading(vertical_arm: Arm) -> None:
    case = Resting(vertical_arm)
    case.filtered()
    assert case.still.all() and case.resting.all()
    assert (case.course.rest > 0.0).all()
    assert np.abs(case.states[-1, [0, 3]] - POSE).max() < 3e-3
    np.testing.assert_allclose(case.window.cells[-1], case.course.readings[-CELL:].mean(axis=0))
    window, hidden = window_of(N_CELL, case.size, case.course.noise / CELL, np.zeros(12)), np.zeros(2)
    window.cells[:] = case.course.readings[: N_CELL * CELL].reshape(N_CELL, CELL, 12).mean(axis=1)
    assert unrest(case.of, room_of(2), window, 0, case.x, case.P, hidden) < 1.0
    np.testing.assert_allclose(case.course.rest[0], rest_variance(hidden, 0.01))


def test_after_a_gap_it_rests_once_a_window_is_full(vertical_arm: Arm) -> None:
    case = Resting(vertical_arm)
    case.course.present[11:13] = False
    case.course.readings[11:13] = np.nan
    case.filtered()
    full = 13 + N_CELL * CELL
    np.testing.assert_array_equal(np.flatnonzero(~case.still), np.arange(11, full))
    np.testing.assert_array_equal(case.course.rest[:, 0] > 0.0, case.still)
    assert np.isfinite(case.states).all() and case.resting.all()


def test_a_strike_is_a_jolt_and_what_no_motion_explains_is_doubted(vertical_arm: Arm) -> None:
    case = Resting(vertical_arm)
    still = np.zeros((1, 2))
    level = specific_force(vertical_arm, POSE[None], still, still).ravel()
    jump = np.array([6.0, -4.0])
    case.course.readings[20] += specific_force(vertical_arm, POSE[None], still, jump[None]).ravel() - level
    case.course.readings[30, 0] += 5.0
    case.filtered()
    np.testing.assert_array_equal(np.flatnonzero(case.course.jolt.any(axis=1)), [20, 21, 30])
    np.testing.assert_allclose(case.course.jolt[20], jump**2, rtol=0.1)
    np.testing.assert_array_equal(np.flatnonzero((case.course.doubt > 1.0).any(axis=1)), [30])


def test_at_rest_readings_are_taken_in_where_it_began_and_speeds_held(vertical_arm: Arm) -> None:
    case = Resting(vertical_arm)
    case.filtered()
    (x, P), room, taken = (case.x.copy(), case.P.copy()), room_of(2), room_to_take(case.course, case.size, 1)[0]
    for k, state in enumerate(case.states):
        if k > 0:
            predict(case.of, case.course, k, x, P)
        correct(case.of, room, case.course, k, case.x, x, P, taken)
        loose = x.copy()
        hold(case.course, k, x, P, taken)
        np.testing.assert_allclose(state, x, rtol=1e-9, atol=1e-12)
    assert np.abs(x - loose)[[1, 4]].min() > 1e-9  # what `hold` does at the last instant


def test_a_flutter_ends_the_hold_but_not_the_rest(vertical_arm: Arm) -> None:
    """Two hundredths of a g on one axis: twice what a cell may be off, and no more than three times."""
    case = Resting(vertical_arm)
    case.course.readings[20:22, 4] += 0.2
    case.filtered()
    assert not case.still[22:26].any() and case.still[:20].all() and case.still[-1]
    assert case.resting.all()


def test_a_motion_ends_the_rest(vertical_arm: Arm) -> None:
    case = Resting(vertical_arm)
    t = 0.01 * np.maximum(np.arange(REST) - 15, 0)[:, None]
    ddq = np.where(t > 0.0, [[8.0, 8.0]], 0.0)
    felt = specific_force(vertical_arm, POSE + 4.0 * t**2, np.hstack([8.0 * t] * 2), ddq)
    case.course.readings[:] += felt.reshape(REST, 12)
    still = np.zeros((1, 2))
    case.course.readings[:] -= specific_force(vertical_arm, POSE[None], still, still).ravel()
    case.filtered()
    assert case.still[:16].all() and not case.still[18:].any()
    assert not case.resting[18:].any()
    assert np.abs(case.states[-1, [1, 4]] - 8.0 * t[-1]).max() < 0.3


def test_a_jump_is_the_weighted_least_squares_one(vertical_arm: Arm) -> None:
    rng, (of, size) = np.random.default_rng(1), observation_of(vertical_arm)
    slopes, miss, noise = rng.normal(size=(12, size)), rng.normal(size=12), rng.uniform(0.1, 1.0, 12)
    A = slopes[:, [2, 5]].copy()
    A[:6, 1] = 0.0  # on the first link nothing feels the second joint
    weighted = A / np.sqrt(noise)[:, None]
    right, *_ = np.linalg.lstsq(weighted, miss / np.sqrt(noise))
    np.testing.assert_allclose(jolt_of(of, noise, slopes, miss, 2), right, rtol=1e-5)


@pytest.mark.parametrize("explained", [True, False])
def test_what_a_jump_does_not_explain_is_doubted_as_far_as_needed(vertical_arm: Arm, explained: bool) -> None:
    case = Resting(vertical_arm)
    of, course, k = case.of, case.course, 3
    jumped = case.x.copy()
    jumped[[2, 5]] += 2.0, -3.0
    course.readings[k] = seen(of, jumped)[0]
    course.readings[k, 0] += 0.0 if explained else 4.0
    course.jolt[k] = 0.5
    (x, P), taken = (case.x.copy(), case.P.copy()), room_to_take(course, case.size, 1)[0]
    before = x.copy(), P.copy()
    take_again(of, room_of(2), course, k, LIMIT, np.zeros(case.size), *before, x, P, taken)
    if explained:
        np.testing.assert_allclose(course.jolt[k], [4.5, 9.5], rtol=1e-4)
        np.testing.assert_array_equal(course.doubt, 1.0)
        np.testing.assert_allclose(x[[2, 5]], [2.0, -3.0], rtol=1e-2)
        return
    jump = np.sqrt(course.jolt[k] - 0.5)
    spread = case.P.copy()
    for j, one in enumerate(jump):
        even = one * np.array([1e-4 / 6.0, 0.005, 1.0])
        spread[3 * j : 3 * j + 3, 3 * j : 3 * j + 3] += np.outer(even, even)
    at = case.x.copy()
    at[[2, 5]] += jump * [1.0, -1.0]
    h, H = seen(of, at)
    miss = course.readings[k] - h - H @ (case.x - at)
    squared = miss @ np.linalg.solve(H @ spread @ H.T + np.diag(course.noise), miss)
    np.testing.assert_allclose(course.doubt[k], squared / 12.0, rtol=1e-6)
    S = H @ spread @ H.T + np.diag(course.noise * squared / 12.0)
    K = np.linalg.solve(S, H @ spread).T
    np.testing.assert_allclose(x, case.x + K @ miss, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(P, spread - K @ S @ K.T, rtol=1e-6, atol=1e-12)


def test_an_offset_that_is_forgotten_is_not_gathered(vertical_arm: Arm) -> None:
    sensors = (replace(vertical_arm.sensors[0], highpass_hz=0.5), *vertical_arm.sensors[1:])
    of, size = observation_of(replace(vertical_arm, sensors=sensors))
    total, x = np.ones(12), np.arange(float(size))
    gather(of, np.full(12, 5.0), x, 2, total)
    np.testing.assert_array_equal(total, [0.0, -1.0, -2.0, *[6.0] * 9])


@pytest.mark.parametrize("lost", [None, 0, 7, 8])
def test_a_first_window_is_there_if_nothing_of_it_was_lost(vertical_arm: Arm, lost: int | None) -> None:
    case = Resting(vertical_arm)
    if lost is not None:
        case.course.present[lost] = False
    window = window_of(N_CELL, case.size, np.ones(12), np.zeros(12))
    window.cells[:] = 3.0
    there = first_window(case.of, case.course, window, CELL, case.x)
    assert there == (lost in (None, 8))
    if there:
        means = case.course.readings[:8].reshape(N_CELL, CELL, 12).mean(axis=1)
        np.testing.assert_allclose(window.cells, means)


@pytest.mark.parametrize(("instants", "enough"), [(7, False), (8, True)])
def test_a_first_window_needs_all_its_cells(vertical_arm: Arm, instants: int, enough: bool) -> None:
    case = Resting(vertical_arm)
    course = case.course._replace(readings=case.course.readings[:instants], present=case.course.present[:instants])
    window = window_of(N_CELL, case.size, np.ones(12), np.zeros(12))
    assert first_window(case.of, course, window, CELL, case.x) == enough
