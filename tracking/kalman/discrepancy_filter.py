"""The live filter of an arm that is not quite the one in its file: cells of readings, to a bank of filters."""

import numpy as np

from arm.model import Arm, Floats
from tracking.kalman.batch_filter import Course
from tracking.kalman.dropout import Loss
from tracking.kalman.kalman_step import Taken
from tracking.kalman.model_bank import advance, ahead, bank_of, mix, sizes_in
from tracking.model.course import Course as Held
from tracking.model.discrepancy import speed_rate
from tracking.model.expected_readings import room_of
from tracking.model.noise import Noise
from tracking.model.observation import observation_of
from tracking.model.process_noise import SMOOTHER_PUSH_STD, WANDER_STD
from tracking.model.zero_velocity import TO_LEAVE, at_rest, rest_variance, unrest, window_frames, window_of

#: Speed of a joint [rad/s or m/s], as the smoother's before it has learnt it.
_USUAL_SPEED = 1.0


class DiscrepancyFilter:
    """Follows an arm, and how much its model lacks of the readings.

    Readings are taken in as means over cells of a hundredth of a second, since what is lacking lasts longer;
    frames within a cell are where the joints are a moment after the last one.

    Parameters
    ----------
    arm : Arm
    x, P : (n_state,), (n_state, n_state)
        State and covariance of a live filter of the arm as its file has it, at the first reading.
    noise : Noise
        Of one sample.
    factor : int
        Samples a frame.
    dt_s : float
        From frame to frame.

    Attributes
    ----------
    resting : bool
        Whether the arm is known to rest.
    """

    def __init__(self, arm: Arm, x: Floats, P: Floats, noise: Noise, factor: int, dt_s: float) -> None:
        n, n_channel = arm.n_joint, arm.n_channel
        mountings = arm.sensor_covariance is not None
        self._of, size = observation_of(arm, mountings, base=True, lack=True)
        self._room, self._n, self._known, self._factor = room_of(n), n, len(x), factor
        moving = len({sensor.joint for sensor in arm.sensors}) > 1  # what one link's sensors share is its own
        self._bank = bank_of(self._of, x, P, moving)
        rows = n_channel + n
        self._taken = Taken(
            np.zeros((n_channel, size)), np.zeros((rows, size)), np.zeros(rows), np.full(rows, np.inf)
        )
        self._cell, n_cell = window_frames(dt_s)
        self._window = window_of(n_cell, size, noise.of_mean(factor * self._cell), noise.rounding)
        self._hidden, self._total = np.zeros(n), np.zeros(n_channel)
        self._coupled = np.repeat(self._of.corner > 0.0, 3)
        push = np.full(n, SMOOTHER_PUSH_STD**2)
        self._held = Held(
            self._cell * dt_s,
            np.zeros((2, n_channel)),
            np.zeros(2, dtype=np.bool_),
            noise.of_mean(factor * self._cell),
            WANDER_STD**2 + noise.rounding,
            push,
            np.zeros((2, n)),
            np.ones((2, n_channel)),
            np.zeros((2, n)),
            speed_rate(push, np.full(n, _USUAL_SPEED)),
        )
        self._loss = Loss(n, self._held.dt)
        self._in_cell, self._there, self._cells = 0, 0, 0
        self._still, self.resting = False, False

    @property
    def state(self) -> tuple[Floats, Floats]:
        """State and covariance, as a live filter of the arm as its file has it knows them."""
        known = slice(0, self._known)
        return self._bank.mean[known].copy(), self._bank.covariance[known, known].copy()

    @property
    def sizes(self) -> tuple[float, float]:
        """What the model lacks of a reading, and by how much its base accelerates along each axis [m/s^2]."""
        return sizes_in(self._bank)

    def retime(self, dt_s: float) -> None:
        """Go on with another time from frame to frame."""
        self._held = self._held._replace(dt=self._cell * dt_s)
        self._loss.retime(self._held.dt)

    def learn(self, noise: Noise) -> None:
        """Go on with what is now known of the noise of a sample."""
        self._held.noise[:] = self._window.noise[:] = noise.of_mean(self._factor * self._cell)
        self._held.wander[:] = WANDER_STD**2 + noise.rounding
        self._window.rounding[:] = noise.rounding

    def skip(self, frames: int) -> None:
        """Let lost frames go by that nobody asks for."""
        for _ in range(frames // self._cell):
            self._miss()

    def follow(self, readings: Floats) -> Course:
        """Take in readings, (n, n_channel), and say what came of each; those of a lost frame are NaN."""
        n, known = len(readings), 3 * self._n + readings.shape[1]
        course = Course(np.empty((n, known)), np.empty((n, self._n)), np.empty(n, np.bool_), np.empty(n, np.bool_))
        k, half, dt = 0, 0.5 * (self._cell - 1), self._held.dt / self._cell
        while k < n:
            part = slice(k, min(n, k + self._cell - self._in_cell))
            there = readings[part][~np.isnan(readings[part, 0])]
            self._total += there.sum(axis=0)
            self._there += len(there)
            steps: Floats = dt * (self._in_cell + 1.0 + half + np.arange(part.stop - k, dtype=np.float64))
            self._in_cell += part.stop - k
            course.still[part] = self._still
            bank = self._bank
            ahead(bank.mean, bank.covariance, steps, course.states[part], course.variances[part])
            if self._in_cell == self._cell:
                self._close_cell()
                last = slice(part.stop - 1, part.stop)
                ahead(
                    bank.mean,
                    bank.covariance,
                    steps[-1:] - self._held.dt,
                    course.states[last],
                    course.variances[last],
                )
            course.resting[part] = self.resting
            k = part.stop
        return course

    def _close_cell(self) -> None:
        whole, mean = self._there == self._cell, self._total / self._cell
        self._total[:], self._in_cell, self._there = 0.0, 0, 0
        if not whole:
            self._miss()
            return
        self._loss.find()
        held = self._held
        held.readings[0], held.present[0] = held.readings[1], held.present[1]
        held.readings[1], held.present[1] = mean, True
        held.rest[1] = rest_variance(self._hidden, held.dt) if self._still else 0.0
        advance(self._of, self._room, held, self._bank, self._taken, self._still)
        offset = self._bank.mean[3 * self._n : 3 * self._n + len(mean)]
        cells = self._window.cells
        cells[self._cells % len(cells)] = mean - np.where(self._coupled, offset, 0.0)
        self._cells += 1
        if self._cells >= len(cells):
            self._settle()

    def _miss(self) -> None:
        """Let a cell go by without readings: what lies on both sides of it is no window."""
        held, bank = self._held, self._bank
        held.present[0], held.present[1] = held.present[1], False
        self._still, self._cells = False, 0
        was_lost = self._loss.lost
        lost = self._loss.miss(bank.mean, bank.covariance)
        if not lost:
            advance(self._of, self._room, held, bank, self._taken, False)
            return
        for x, P in zip(bank.x, bank.P, strict=True):
            if not was_lost:
                self._loss.forget(x, P)
        mix(bank)

    def _settle(self) -> None:
        bank, oldest = self._bank, self._cells % len(self._window.cells)
        share = unrest(self._of, self._room, self._window, oldest, bank.mean, bank.covariance, self._hidden)
        was_still, self._still = self._still, share < 1.0
        self.resting = share < (TO_LEAVE if self.resting else 1.0)
        if self._still and not was_still:
            for at, x in zip(bank.at, bank.x, strict=True):
                at[:] = at_rest(x, self._n)
