"""One step of the filter over readings, against a dense textbook filter and filterpy's."""

from dataclasses import replace

import numpy as np
import pytest
from filterpy.kalman import ExtendedKalmanFilter
from scipy.linalg import expm

from arm.model import Arm
from tracking.kalman.kalman_step import (
    correct,
    filter_step,
    forgetting,
    hold,
    predict,
    room_to_take,
    spread,
    take,
)
from tracking.model.course import Course
from tracking.model.expected_readings import observe, room_of
from tracking.model.observation import Observation, observation_of, other_clocks

DT, MEMORY_S = 0.01, 0.3
KINDS = ["plain", "AC-coupled", "corner sought", "base and lack", "clocks"]


class Case:
    """Three instants of a small arm, its state and what is known of that."""

    def __init__(self, arm: Arm, kind: str, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        if kind in ("AC-coupled", "corner sought"):
            sensors = [replace(s, highpass_hz=2.0 * (k % 2)) for k, s in enumerate(arm.sensors)]
            arm = replace(arm, sensors=tuple(sensors))
        lacking = kind == "base and lack"
        clocks = other_clocks(arm) if kind == "clocks" else ()
        self.of, size = observation_of(arm, kind == "corner sought", lacking, lacking, clocks)
        n, n_channel = arm.n_joint, arm.n_channel
        self.n, self.size, self.n_channel = n, size, n_channel
        present, rest = np.ones(3, dtype=np.bool_), np.zeros((3, n))
        present[0], rest[2, 1] = False, 1e-3
        doubt, jolt = rng.uniform(1.0, 3.0, (3, n_channel)), rng.uniform(1.0, 9.0, (3, n))
        self.course = Course(
            DT,
            rng.normal(0.0, 5.0, (3, n_channel)),
            present,
            rng.uniform(1e-2, 1e-1, n_channel),
            rng.uniform(1e-3, 1e-2, n_channel),
            np.array([4.0, 9.0]),
            jolt,
            doubt,
            rest,
            np.array([30.0, 0.0]),
            0.4,
            rng.uniform(0.1, 0.3, n_channel),
            MEMORY_S,
            rng.normal(0.0, 20.0, (3, n_channel)),
        )
        root = 0.1 * rng.normal(size=(size, size))
        self.x, self.P = 0.1 * rng.normal(size=size), root @ root.T + 0.01 * np.eye(size)

    def before(self) -> tuple[np.ndarray, np.ndarray]:
        return self.x.copy(), self.P.copy()


def textbook(case: Case, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Return state and covariance at instant k by dense matrices."""
    of, course, n, size = case.of, case.course, case.n, case.size
    F, Q, shift = np.eye(size), np.zeros((size, size)), np.zeros(size)
    for j, rate in enumerate(course.rate):
        joint = slice(3 * j, 3 * j + 3)
        F[joint, joint] = expm(DT * np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -(rate**2), -2.0 * rate]]))
        even = np.array([DT**2 / 6.0, DT / 2.0, 1.0])
        Q[joint, joint] = (course.push[j] * DT + course.jolt[k, j]) * np.outer(even, even)
    both = course.present[k - 1] and course.present[k]
    for c in range(case.n_channel):
        o, s = 3 * n + c, c // 3
        Q[o, o] = course.wander[c] * DT
        if of.corner[s] == 0.0:
            continue
        settled, late = of.settled_column[s] + c % 3, of.corner_column[s]
        corner = of.corner[s] + (case.x[late] if late >= 0 else 0.0)
        stands = course.readings[k - 1 : k + 1, c].mean() - case.x[settled] if both else 0.0
        F[o, settled] = DT * corner
        shift[o] = -DT * corner * (stands + case.x[settled])
        if late >= 0:
            F[o, late] = -DT * stands
            shift[o] += DT * stands * case.x[late]
        Q[o, o] += (DT * corner) ** 2 * (course.noise[c] + (0.0 if both else 1.0))
    for first, stds in ((of.base_column, np.full(3, course.base_std)), (of.lack_column, course.lack_std)):
        if first >= 0:
            entries = np.arange(first, first + len(stds))
            F[entries, entries] = np.exp(-DT / MEMORY_S)
            Q[entries, entries] = stds**2 * (1.0 - np.exp(-2.0 * DT / MEMORY_S))
    return F @ case.x + shift, F @ case.P @ F.T + Q


def expected(of: Observation, at: np.ndarray, drift: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return readings in a state and their slopes; a late clock shows what was read so much before."""
    reading, slope = np.empty(3 * of.link.size), np.zeros((3 * of.link.size, at.size))
    observe(of, room_of(of.chain.revolute.size), at, reading, slope)
    for channel, clock in enumerate(np.repeat(of.clock_column, 3)):
        if clock >= 0:
            reading[channel] -= drift[channel] * at[clock]
            slope[channel, clock] = -drift[channel]
    return reading, slope


@pytest.fixture(params=KINDS)
def case(request: pytest.FixtureRequest, vertical_arm: Arm) -> Case:
    return Case(vertical_arm, request.param)


@pytest.mark.parametrize("k", [1, 2], ids=["after a loss", "seen throughout"])
def test_a_prediction_is_the_textbooks(case: Case, k: int) -> None:
    x, P = case.before()
    predict(case.of, case.course, k, x, P)
    right_x, right_P = textbook(case, k)
    np.testing.assert_allclose(x, right_x, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(P, right_P, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(P, P.T)


def test_readings_are_taken_in_as_filterpy_does(case: Case) -> None:
    x, P = case.before()
    at, taken = case.x + 0.02, room_to_take(case.course, case.size, 1)[0]
    squared = correct(case.of, room_of(case.n), case.course, 2, at, x, P, taken)
    kf = ExtendedKalmanFilter(case.size, case.n_channel)
    kf.x, kf.P = case.before()
    reading, H = expected(case.of, at, case.course.drift[2])
    R = np.diag(case.course.noise * case.course.doubt[2])
    kf.update(case.course.readings[2], lambda _: H, lambda state: reading + H @ (state - at), R=R)
    np.testing.assert_allclose(x, kf.x, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(P, kf.P, rtol=1e-7, atol=1e-9)
    assert squared == pytest.approx(kf.y @ kf.SI @ kf.y)
    assert np.log(taken.total[: case.n_channel]).sum() == pytest.approx(np.linalg.slogdet(kf.S)[1])


def test_one_reading_is_taken_in_by_the_closed_form() -> None:
    rng, size, columns = np.random.default_rng(1), 5, np.array([3, 1, 0])
    root, x, gain = rng.normal(size=(size, size)), rng.normal(size=size), np.full(size, np.nan)
    P, slope = root @ root.T, rng.normal(size=size)
    h = np.zeros(size)
    h[[3, 1]] = slope[[3, 1]]  # the third is beyond those that count
    total = h @ P @ h + 0.3
    right = x + P @ h * 0.7 / total, P - np.outer(P @ h, P @ h) / total
    K = P @ h / total
    assert take(x, P, slope, columns, 2, 0.7, 0.3, gain) == pytest.approx(total)
    np.testing.assert_allclose(gain, K)
    np.testing.assert_allclose(x, right[0])
    np.testing.assert_allclose(P, right[1])


def test_only_joints_known_to_rest_are_held(vertical_arm: Arm) -> None:
    case = Case(vertical_arm, "plain")
    (x, P), taken = case.before(), room_to_take(case.course, case.size, 1)[0]
    hold(case.course, 2, x, P, taken)
    at, variance = 4, case.course.rest[2, 1]  # the speed of joint 2
    K = case.P[:, at] / (case.P[at, at] + variance)
    np.testing.assert_allclose(x, case.x - K * case.x[at])
    np.testing.assert_allclose(P, case.P - np.outer(K, case.P[at]), atol=1e-12)
    assert taken.total[case.n_channel] == np.inf
    assert taken.miss[case.n_channel + 1] == -case.x[at]
    np.testing.assert_allclose(taken.gain[case.n_channel + 1], K)


@pytest.mark.parametrize("k", [0, 1, 2])
def test_a_step_predicts_takes_in_and_holds(vertical_arm: Arm, k: int) -> None:
    case = Case(vertical_arm, "plain")
    room, at = room_of(case.n), np.tile(case.x, (3, 1))
    (x, P), taken = case.before(), room_to_take(case.course, case.size, 1)[0]
    taken.total[:] = 7.0
    squared = filter_step(case.of, room, case.course, k, at, x, P, taken)
    (right_x, right_P), other = case.before(), room_to_take(case.course, case.size, 1)[0]
    right = 0.0
    if k > 0:
        predict(case.of, case.course, k, right_x, right_P)
        right = correct(case.of, room, case.course, k, at[k], right_x, right_P, other)
    hold(case.course, k, right_x, right_P, other)
    np.testing.assert_array_equal(x, right_x)
    np.testing.assert_array_equal(P, right_P)
    assert squared == right
    seen = [k > 0] * case.n_channel + [False, k == 2]
    np.testing.assert_array_equal(np.isfinite(taken.total), seen)


def test_an_even_change_of_acceleration_moves_all_three_together() -> None:
    """A ramp up to 1 within 0.1 s: its integral is 0.05, and that one's 1/600."""
    P = np.zeros((6, 6))
    spread(P, 1, 4.0, 0.1)
    gain = np.array([0.0, 0.0, 0.0, 0.01 / 6.0, 0.05, 1.0])
    np.testing.assert_allclose(P, 4.0 * np.outer(gain, gain), atol=1e-15)


def test_what_is_forgotten_is_the_reading_beyond_where_it_settles(vertical_arm: Arm) -> None:
    case = Case(vertical_arm, "corner sought")
    channel = 4  # the second sensor's y
    x = case.x.copy()
    x[case.of.settled_column[1] + 1], x[case.of.corner_column[1]] = 0.5, 0.25
    case.course.readings[1, channel], case.course.readings[2, channel] = 2.0, 4.0
    corner, stands = forgetting(case.of, case.course, 2, channel, x)
    assert corner == pytest.approx(2.0 * np.pi * 2.0 + 0.25)
    assert stands == pytest.approx(2.5)
    assert forgetting(case.of, case.course, 1, channel, x)[1] == 0.0


def test_room_has_a_row_for_each_reading_and_joint(vertical_arm: Arm) -> None:
    case = Case(vertical_arm, "plain")
    rooms = room_to_take(case.course, case.size, 3)
    assert len(rooms) == 3
    assert rooms[0].slope.shape == (12, case.size) and rooms[0].gain.shape == (14, case.size)
    assert rooms[0].miss.shape == rooms[0].total.shape == (14,)
    rooms[0].miss[:] = 1.0
    assert not rooms[1].miss.any()
