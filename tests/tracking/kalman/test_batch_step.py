"""Frames in one go, against filterpy's filter frame by frame; and where they end."""

import numpy as np
import pytest
from filterpy.kalman import ExtendedKalmanFilter

from arm.model import Arm
from tracking.kalman.batch_step import stride
from tracking.model.expected_readings import observe, room_of
from tracking.model.observation import observation_of

N, N_JOINT, N_CHANNEL = 4, 2, 12


class Case:
    """An arm's filter and four frames of readings, near what it expects."""

    def __init__(self, arm: Arm, still: bool) -> None:
        rng = np.random.default_rng(3)
        self.of, self.size = observation_of(arm)
        self.rows, self.still = N_CHANNEL + N_JOINT * still, still
        self.F = np.eye(self.size) + 0.01 * rng.normal(size=(self.size, self.size))
        self.Q = np.diag(rng.uniform(1e-4, 1e-3, self.size))
        self.x = 0.1 * rng.normal(size=self.size)
        root = 0.1 * rng.normal(size=(self.size, self.size))
        self.P = root @ root.T + 1e-3 * np.eye(self.size)
        self.rest_at = self.x + 0.01
        self.noise = np.diag(rng.uniform(0.01, 0.1, self.rows))
        self.readings = self.expected(self.x)[0][:N_CHANNEL] + 0.1 * rng.normal(size=(N, N_CHANNEL))

    def expected(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what is read in a state and its slopes; of an arm that rests, the speeds too."""
        reading, slope = np.empty(self.rows), np.zeros((self.rows, self.size))
        observe(self.of, room_of(N_JOINT), x, reading[:N_CHANNEL], slope[:N_CHANNEL])
        if self.still:
            reading[N_CHANNEL:] = x[[1, 4]]
            slope[[N_CHANNEL, N_CHANNEL + 1], [1, 4]] = 1.0
        return reading, slope

    def textbook(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, ExtendedKalmanFilter]:
        """Return states, variances of the angles and innovations' sizes frame by frame, and the filter after."""
        kf = ExtendedKalmanFilter(self.size, self.rows)
        kf.x, kf.P, kf.F, kf.Q = self.x.copy(), self.P.copy(), self.F, self.Q
        states, variances, sizes = [], [], []
        for reading in self.readings:
            kf.x, kf.P = kf.F @ kf.x, kf.F @ kf.P @ kf.F.T + kf.Q
            at = self.rest_at if self.still else kf.x.copy()
            h, H = self.expected(at)
            z = np.append(reading, np.zeros(self.rows - N_CHANNEL))
            kf.update(z, lambda _, H=H: H, lambda x, h=h, H=H, at=at: h + H @ (x - at), R=self.noise)
            states.append(kf.x[:18].copy())
            variances.append(np.diag(kf.P)[[0, 3]])
            sizes.append(kf.y @ kf.SI @ kf.y)
        return np.array(states), np.array(variances), np.array(sizes), kf

    def taken(self, limit: float = np.inf) -> tuple:
        """Return count, state and covariance after, and what was filled in."""
        slope = np.zeros((self.rows, self.size))
        if self.still:
            slope[[N_CHANNEL, N_CHANNEL + 1], [1, 4]] = 1.0
        filled = np.zeros((N, 18)), np.zeros((N, N_JOINT)), np.zeros(N), np.ones(N_CHANNEL)
        count, x, P = stride(
            self.of,
            room_of(N_JOINT),
            self.F,
            self.Q,
            self.x,
            self.P,
            self.readings,
            self.rest_at,
            self.still,
            self.noise,
            limit,
            slope,
            np.zeros(self.rows),
            *filled,
        )
        return count, x, P, *filled


@pytest.mark.parametrize("still", [False, True], ids=["moving", "at rest"])
def test_every_frame_is_filterpys(vertical_arm: Arm, still: bool) -> None:
    case = Case(vertical_arm, still)
    right_states, right_variances, right_sizes, kf = case.textbook()
    count, x, P, states, variances, sizes, total = case.taken()
    assert count == N
    np.testing.assert_allclose(states, right_states, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(variances, right_variances, rtol=1e-6)
    np.testing.assert_allclose(sizes, right_sizes, rtol=1e-6)
    np.testing.assert_allclose(x, kf.x, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(P, kf.P, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(total, 1.0 + case.readings.sum(axis=0))


@pytest.mark.parametrize("bad", ["lost", "unexplained", "infinite"])
def test_it_ends_before_the_first_bad_frame(vertical_arm: Arm, bad: str) -> None:
    case = Case(vertical_arm, still=False)
    right_states, _, right_sizes, _ = case.textbook()
    limit = np.inf
    if bad == "lost":
        case.readings[2] = np.nan
    elif bad == "infinite":
        case.readings[2, 5] = np.inf
    else:
        case.readings[2] += 100.0
        limit = 1.01 * right_sizes[:2].max()
    count, x, _, states, _, sizes, total = case.taken(limit)
    assert count == 2
    np.testing.assert_allclose(x, np.append(states[1], x[18:]))
    np.testing.assert_allclose(states[:2], right_states[:2], rtol=1e-6, atol=1e-9)
    assert not states[2:].any() and not sizes[2:].any()
    np.testing.assert_allclose(total, 1.0 + case.readings[:2].sum(axis=0))
