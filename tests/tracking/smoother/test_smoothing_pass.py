"""One pass of smoothing against the same problem solved densely, all instants at once."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from tracking.kalman.kalman_step import filter_step, room_to_take
from tracking.model.course import Course
from tracking.model.expected_readings import observe, room_of
from tracking.model.observation import observation_of
from tracking.smoother.smoothing_pass import pass_of, smooth_in_stretches, smooth_once

DT = 0.01
N = 12
CASES = ["plain", "AC-coupled", "mountings", "discrepancy", "gyroscopes", "gyroscopes, discrepancy"]
PUSH, MEMORY_S = np.array([4.0, 9.0]), 0.05


def seen(of, x):
    reading, slope = np.empty(3 * of.link.size), np.zeros((3 * of.link.size, x.size))
    observe(of, room_of(of.chain.revolute.size), x, reading, slope)
    return reading, slope


class Problem:
    """A short course of the arm with a gap, a jolt, a doubted reading and a rest; and the prior."""

    def __init__(self, arm, case, seed=0, eventful=True):
        rng = np.random.default_rng(seed)
        if "AC-coupled" in case:
            sensors = [replace(s, highpass_hz=2.0 * (k % 2)) for k, s in enumerate(arm.sensors)]
            arm = replace(arm, sensors=tuple(sensors))
        lacking = "discrepancy" in case
        sought = case in ("mountings", "gyroscopes", "AC-coupled, sought")
        if "gyroscopes" in case:
            arm = arm.with_gyroscopes(["s2", "s3"])
        self.of, self.size = observation_of(arm, sought, lacking, lacking)
        self.n = arm.n_joint
        n, n_channel = self.n, arm.n_channel
        jolt, doubt, rest = np.zeros((N, n)), np.ones((N, n_channel)), np.zeros((N, n))
        present = np.ones(N, dtype=np.bool_)
        if eventful:
            present[4:6], jolt[4:7] = False, 25.0
            jolt[8, 1], doubt[9] = 400.0, 30.0 + np.arange(n_channel)
            rest[:2], rest[11, 0] = 1e-6, 1e-4
        std = rng.uniform(0.01, 0.1, self.size)
        std[0] = 1e-5  # what everything is counted from
        turned = np.linalg.qr(rng.normal(size=(self.size, self.size)))[0]
        mixed = np.diag(std) @ (np.eye(self.size) + 0.2 * turned)
        self.x0, self.P0 = 0.1 * rng.normal(size=self.size), mixed @ mixed.T
        self.x0[3 * n + n_channel :] *= 0.1
        self.at = self.x0 + 0.05 * rng.normal(size=(N, self.size))
        readings = np.stack([seen(self.of, x)[0] for x in self.at]) + 0.3 * rng.normal(size=(N, n_channel))
        self.course = Course(
            DT,
            np.where(present[:, None], readings, 0.0),
            present,
            rng.uniform(1e-4, 1e-3, n_channel),
            rng.uniform(1e-3, 1e-2, n_channel),
            PUSH,
            jolt,
            doubt,
            rest,
            np.array([30.0, 0.0]) * lacking,
            0.4,
            rng.uniform(0.1, 0.3, n_channel),
            MEMORY_S,
        )

    def filtered(self):
        """Return what the filter makes of every instant, (N, size)."""
        x, P, states = self.x0.copy(), self.P0.copy(), np.empty((N, self.size))
        room, taken = room_of(self.n), room_to_take(self.course, self.size, 1)[0]
        for k in range(N):
            filter_step(self.of, room, self.course, k, self.at, x, P, taken)
            states[k] = x
        return states

    def stood(self, k, filtered):
        """Return where each reading stood in the step up to k: what was lost, where the filter has it settle."""
        if self.course.present[k - 1] and self.course.present[k]:
            return 0.5 * (self.course.readings[k - 1] + self.course.readings[k]), 0.0
        settles = np.zeros(self.course.noise.size)
        for channel in np.flatnonzero(np.repeat(self.of.corner, 3)):
            settles[channel] = filtered[k - 1, self.of.settled_column[channel // 3] + channel % 3]
        return settles, 1.0

    def dense(self):
        """Return states and their covariances, (N, size) and (N, size, size), by one least-squares problem.

        Unknown are what, whitened, x0 differs by from its prior and what drives the state from instant to instant.
        """
        n, size, course, of = self.n, self.size, self.course, self.of
        n_channel = course.noise.size
        F = np.eye(size)
        for j, rate in enumerate(course.rate):
            motion = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -(rate**2), -2.0 * rate]])
            F[3 * j : 3 * j + 3, 3 * j : 3 * j + 3] = expm(motion * DT)
        kept = np.exp(-DT / course.memory_s)
        processes = [(of.base_column, 3, course.base_std), (of.lack_column, n_channel, course.lack_std)]
        for first, count, _ in processes:
            if first >= 0:
                F[range(first, first + count), range(first, first + count)] = kept
        offsets, rate, filtered = 3 * n + np.arange(n_channel), DT * np.repeat(of.corner, 3), self.filtered()
        drives = n + n_channel + 3 + n_channel
        unknowns = size + (N - 1) * drives
        mean, of_unknowns = [self.x0], [np.zeros((size, unknowns))]
        of_unknowns[0][:, :size] = np.linalg.cholesky(self.P0)
        for k in range(1, N):
            stood, lost = self.stood(k, filtered)
            now, shift, first = F.copy(), np.zeros(size), size + (k - 1) * drives
            shift[offsets] = -rate * stood
            for channel in np.flatnonzero(rate):
                now[offsets[channel], of.settled_column[channel // 3] + channel % 3] = rate[channel]
            moved = now @ of_unknowns[-1]
            for j in range(n):
                std = np.sqrt(course.push[j] * DT + course.jolt[k, j])
                moved[3 * j : 3 * j + 3, first + j] += std * np.array([DT**2 / 6, DT / 2, 1.0])
            wander = course.wander * DT + rate**2 * (course.noise + lost)
            moved[offsets, first + n + np.arange(n_channel)] += np.sqrt(wander)
            drive = first + n + n_channel
            for column, count, std in processes:
                if column >= 0:
                    entries = np.arange(count)
                    moved[column + entries, drive + entries] += std * np.sqrt(1.0 - kept**2)
                    drive += count
            mean.append(now @ mean[-1] + shift)
            of_unknowns.append(moved)
        rows, misses = [np.eye(unknowns)], [np.zeros(unknowns)]
        for k in range(N):
            if course.present[k]:
                reading, slope = seen(of, self.at[k])
                std = np.sqrt(course.noise * course.doubt[k])
                miss = course.readings[k] - reading - slope @ (mean[k] - self.at[k])
                rows.append(slope @ of_unknowns[k] / std[:, None])
                misses.append(miss / std)
            for j in np.flatnonzero(course.rest[k]):
                std = np.sqrt(course.rest[k, j])
                rows.append(of_unknowns[k][3 * j + 1][None] / std)
                misses.append(np.array([-mean[k][3 * j + 1] / std]))
        Q, R = np.linalg.qr(np.vstack(rows))
        z = np.linalg.solve(R, Q.T @ np.concatenate(misses))
        roots = [np.linalg.solve(R.T, M.T).T for M in of_unknowns]
        states = np.stack([m + M @ z for m, M in zip(mean, of_unknowns, strict=True)])
        return states, np.stack([root @ root.T for root in roots])

    def pass_once(self):
        x, P = self.x0.copy(), self.P0.copy()
        found = pass_of(self.of, self.course, self.size)
        self.cost = smooth_once(self.of, room_of(self.n), self.course, self.at, x, P, found, True)
        self.found = found
        return found.states, found.variance, x, P


@pytest.fixture(params=CASES)
def problem(request, dd_arm):
    return Problem(dd_arm, request.param)


def assert_close(found, states, covariance):
    """Hold states against the dense ones: to a millionth of what is known of them, and of their own size."""
    std = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
    assert (np.abs(found - states) <= 1e-6 * (std + np.abs(states))).all()


def test_a_pass_is_the_dense_solution(problem):
    states, covariance = problem.dense()
    smoothed, variance, _, _ = problem.pass_once()
    assert_close(smoothed, states, covariance)
    expected = np.diagonal(covariance, axis1=1, axis2=2)[:, problem.of.reported]
    np.testing.assert_allclose(variance, expected, rtol=1e-6)


def test_smoothing_errors_are_the_residuals(problem):
    """R u is what the smoothed states leave of a reading, and R - R^2 D the variance that it is known with."""
    states, covariance = problem.dense()
    problem.pass_once()
    of, course, n_channel = problem.of, problem.course, problem.course.noise.size
    for k in np.flatnonzero(course.present):
        reading, slope = seen(of, problem.at[k])
        R = course.noise * course.doubt[k]
        left = course.readings[k] - reading - slope @ (states[k] - problem.at[k])
        np.testing.assert_allclose(R * problem.found.error[k, :n_channel], left, rtol=1e-5, atol=1e-9)
        known = np.diag(slope @ covariance[k] @ slope.T)
        np.testing.assert_allclose(R - R**2 * problem.found.precision[k, :n_channel], known, rtol=1e-4, atol=1e-12)


def test_what_is_left_behind_is_the_last_instant(problem):
    states, covariance = problem.dense()
    _, _, x, P = problem.pass_once()
    assert_close(x, states[-1], covariance[-1])
    std = np.sqrt(np.diag(covariance[-1]))
    np.testing.assert_allclose(P / np.outer(std, std), covariance[-1] / np.outer(std, std), rtol=0, atol=1e-6)


@pytest.mark.parametrize("stretch", [1, 7, N - 1])
def test_what_is_filtered_again_is_what_was_kept(problem, stretch):
    states, variance, x, P = problem.pass_once()
    again, x_again, P_again = (
        pass_of(problem.of, problem.course, problem.size),
        problem.x0.copy(),
        problem.P0.copy(),
    )
    room = room_of(problem.n)
    cost = smooth_in_stretches(
        problem.of, room, problem.course, problem.at, x_again, P_again, again, True, stretch
    )
    assert cost == problem.cost
    for one, other in ((again.states, states), (again.variance, variance), (x_again, x), (P_again, P)):
        np.testing.assert_array_equal(one, other)


def test_steps_one_by_one_end_at_the_dense_solution(problem):
    """A filter does not know what follows, but at the end all is known."""
    states, covariance = problem.dense()
    assert_close(problem.filtered()[-1], states[-1], covariance[-1])


def test_every_event_of_the_course_counts(dd_arm):
    """Without any one of them the dense solution would be another: they are not there for nothing."""
    problem = Problem(dd_arm, "plain")
    states, covariance = problem.dense()
    plain = Problem(dd_arm, "plain", eventful=False).course
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    for name in ("present", "jolt", "doubt", "rest"):
        other = Problem(dd_arm, "plain")
        other.course = other.course._replace(**{name: getattr(plain, name)})
        assert (np.abs(other.dense()[0] - states) > 0.01 * std).any(), name
