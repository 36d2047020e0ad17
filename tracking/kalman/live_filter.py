"""The filter's steps, one frame at a time, on filterpy's extended Kalman filter.

The same model, the same rests, jolts and doubts as in `tracking.kalman.forward_filter`, which takes readings in
one after the other where this takes them in at once; tests hold the two against each other.
"""

import math

import numpy as np

from arm.model import Arm, Floats
from tracking.kalman.dropout import Loss
from tracking.kalman.extended_kalman import CompiledKalmanFilter
from tracking.kalman.forward_filter import jolt_of
from tracking.kalman.kalman_step import spread
from tracking.model.expected_readings import observe, room_of
from tracking.model.first_rest import RESTING_SPEED_STD, first_readings
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.innovation_test import Consistency, Judge
from tracking.model.noise import Noise
from tracking.model.observation import observation_of
from tracking.model.process_noise import FILTER_PUSH_STD, SMOOTHER_PUSH_STD, WANDER_STD, alarm_limit
from tracking.model.zero_velocity import TO_LEAVE, at_rest, rest_variance, unrest, window_frames, window_of


class LiveFilter:
    """Follows an arm reading by reading.

    Parameters
    ----------
    arm : Arm
    q : (n_joint,)
        Where the arm rests at first.
    given : bool
        Somebody measured ``q``, see `tracking.model.initial_state.start_state`.
    first : (n_frame, n_channel)
        The first readings, a quarter of a second of frames; they are not taken in.
    noise : Noise
        Of one sample.
    factor : int
        Samples a frame.
    dt_s : float
        From frame to frame.

    Attributes
    ----------
    loss : Loss
        For how long nothing was read, and what was known before.
    misfit : float
        The squared sizes of all innovations so far, as they were before anything was allowed for.
    resting : bool
        Whether the arm is known to rest.
    """

    def __init__(
        self, arm: Arm, q: Floats, given: bool, first: Floats, noise: Noise, factor: int, dt_s: float
    ) -> None:
        n, n_channel = arm.n_joint, arm.n_channel
        of, size = observation_of(arm, arm.sensor_covariance is not None)
        self._of, self._room, self._n, self._n_channel = of, room_of(n), n, n_channel
        x, P = start_state(arm, of, size, first_readings(first, dt_s, noise, factor), q, given, MountingPrior())
        # Readings show a speed by its square: who linearises once, at zero, learns nothing of it and begins slow.
        speeds = np.arange(1, 3 * n, 3)
        P[speeds, speeds] = RESTING_SPEED_STD**2
        kf = CompiledKalmanFilter(dim_x=size, dim_z=n_channel)
        kf.x, kf.P, kf.F, kf.Q = x, P, np.eye(size), np.zeros((size, size))
        self._offsets = np.arange(3 * n, 3 * n + n_channel)
        self._coupled = np.repeat(of.corner > 0.0, 3)
        self._any_coupled = bool(self._coupled.any())
        self._kf = kf
        self._step_by(dt_s)
        self._slope = np.zeros((n_channel + n, size))
        for j in range(n):
            self._slope[n_channel + j, 3 * j + 1] = 1.0
        self._rest_noise = np.zeros((n_channel + n, n_channel + n))
        self._values = np.zeros(n_channel + n)  # a joint at rest reads a speed of zero
        self._predicted = np.zeros(n_channel + n)
        self._limits = alarm_limit(n_channel), alarm_limit(n_channel + n)
        self._last = np.full(n_channel, np.nan)
        self._factor = factor
        self._cell, n_cell = window_frames(dt_s)
        self._window = window_of(n_cell, size, noise.of_mean(factor * self._cell), noise.rounding)
        self._total, self._in_cell, self._cells = np.zeros(n_channel), 0, 0
        self._hidden = np.zeros(n)
        self.learn(noise)
        self._judge = Judge()
        self.misfit = 0.0
        self._strain, self._strained = 0.0, 0
        self._begun = False
        self.loss = Loss(n, dt_s)
        self._still, self._rest_at = False, x
        self._settle(self._first_window(first))
        self.resting = True

    @property
    def x(self) -> Floats:
        """The state, (n_state,), in the order of `tracking.model.observation`."""
        return np.asarray(self._kf.x, dtype=np.float64)

    @property
    def angle_variance(self) -> Floats:
        """Variance of each angle, (n_joint,)."""
        return np.asarray(np.diagonal(self._kf.P)[: 3 * self._n : 3], dtype=np.float64)

    def step(self, reading: Floats) -> bool:
        """Go on by a frame and take in its reading, (n_channel,); without one (NaN) the motion is predicted.

        Returns
        -------
        bool
            Whether the arm was held to be at rest.
        """
        kf = self._kf
        lost = reading[0] != reading[0]  # not a number
        before_x, before_P = kf.x, kf.P
        if not lost:
            self.loss.find()
        elif self.loss.miss(kf.x, kf.P):
            return False
        if self._begun:
            self._predict(reading)
        self._begun = True
        self._last = reading
        if lost:
            self._in_cell, self._cells, self._still = 0, 0, False  # what lies on both sides of a gap is no window
            self._total[:] = 0.0
            return False
        still = self._still
        try:
            self._take(reading, still)
        except np.linalg.LinAlgError:
            kf.x[0] = np.nan
        if not math.isfinite(kf.x.sum()):
            self._give_up(before_x, before_P)
        self._total += reading
        if self._any_coupled:
            self._total -= np.where(self._coupled, kf.x[self._offsets], 0.0)
        self._in_cell += 1
        if self._in_cell == self._cell:
            self._close_cell()
        return still

    def retime(self, dt_s: float) -> None:
        """Go on with another time from frame to frame."""
        self._step_by(dt_s)
        self._wander()
        self.loss.retime(dt_s)

    def _step_by(self, dt_s: float) -> None:
        """Let frames be so far apart."""
        kf, n, of = self._kf, self._n, self._of
        self._dt = dt_s
        kf.Q[: 3 * n, : 3 * n] = 0.0
        for j in range(n):
            kf.F[3 * j, 3 * j + 1] = kf.F[3 * j + 1, 3 * j + 2] = dt_s
            kf.F[3 * j, 3 * j + 2] = dt_s**2 / 2.0
            spread(kf.Q, j, FILTER_PUSH_STD**2 * dt_s, dt_s)
        self._forget = dt_s * np.repeat(of.corner, 3)
        for channel in np.flatnonzero(self._coupled):
            kf.F[3 * n + channel, of.settled_column[channel // 3] + channel % 3] = self._forget[channel]

    def _wander(self) -> None:
        wander = (WANDER_STD**2 + self._rounding) * self._dt
        self._kf.Q[self._offsets, self._offsets] = wander + self._forget**2 * self._noise

    def learn(self, noise: Noise) -> None:
        """Go on with what is now known of the noise of a sample."""
        self._noise, self._rounding = noise.of_mean(self._factor), noise.rounding
        self._wander()
        self._moving_noise = np.diag(self._noise)
        self._rest_noise[: self._n_channel, : self._n_channel] = self._moving_noise
        # What the converter hid was taken for offsets all the while.
        hidden = np.maximum(noise.rounding - self._window.rounding, 0.0)
        self._kf.P[self._offsets, self._offsets] += hidden
        self._window.noise[:] = noise.of_mean(self._factor * self._cell)
        self._window.rounding[:] = noise.rounding

    def _give_up(self, x: Floats, P: Floats) -> None:
        """Begin anew from the last state that made sense: no motion of this arm explains the readings at all."""
        self._kf.x, self._kf.P = x, P
        self.loss.forget(x, P)
        self._judge.note(np.inf, jolted=True, doubted=True)

    def consistency(self) -> Consistency:
        """Return how well the readings since the last call fit the filter's claims."""
        return self._judge.take()

    def strain(self) -> float:
        """Return the mean square of the innovations since the last call, none larger than noise makes it."""
        strain = self._strain / max(1, self._strained)
        self._strain, self._strained = 0.0, 0
        return strain

    @property
    def state(self) -> tuple[Floats, Floats]:
        """State and covariance."""
        return self._kf.x.copy(), self._kf.P.copy()

    def begin_anew(self, x: Floats, P: Floats) -> None:
        """Go on from another state and covariance."""
        self._kf.x, self._kf.P = x.copy(), P.copy()
        self._rest_at = at_rest(x, self._n)

    def _predict(self, reading: Floats) -> None:
        kf, shift = self._kf, None
        if self._any_coupled:
            shift = np.zeros(len(kf.x))
            stands = 0.5 * (self._last + reading)
            lost = np.isnan(stands)
            settled = kf.F[self._offsets] @ kf.x - kf.x[self._offsets]  # as if it had stood where it settles
            shift[self._offsets] = np.where(lost, -settled, -self._forget * np.where(lost, 0.0, stands))
            kf.P[self._offsets, self._offsets] += self._forget**2 * lost
        kf.predict(shift)
        if reading[0] != reading[0]:
            for j in range(self._n):  # nobody saw a jolt, so there may have been one
                spread(kf.P, j, SMOOTHER_PUSH_STD**2 * self._dt, self._dt)

    def _take(self, reading: Floats, still: bool) -> None:
        kf, rows = self._kf, self._n_channel + (self._n if still else 0)
        values = self._values[:rows]
        values[: self._n_channel] = reading
        noise = self._rest_noise if still else self._moving_noise
        # While the arm rests it is linearised where the rest began: what noise does to the slopes is no
        # information.
        at, limit = self._rest_at.copy() if still else kf.x.copy(), self._limits[still]
        before_x, before_P = kf.x, kf.P
        squared = self._correct(values, at, rows, noise)
        self.misfit += squared if math.isfinite(squared) else 0.0  # a reading without sense says nothing
        self._strain += min(squared, limit) / rows if math.isfinite(squared) else limit / rows
        self._strained += 1
        jolted = doubted = False
        if squared > limit:
            jolted = True
            observe(self._of, self._room, before_x, self._predicted[: self._n_channel], self._slope)
            miss = reading - self._predicted[: self._n_channel]
            at = before_x.copy()
            jump = jolt_of(self._of, self._noise, self._slope, miss, self._n)
            for j in range(self._n):
                spread(before_P, j, jump[j] ** 2, self._dt)
                at[3 * j + 2] += jump[j]  # where the readings are explained is where they are best linearised
            kf.x, kf.P = before_x, before_P
            squared = self._correct(values, at, rows, noise)
            if squared > limit:
                doubted = True
                doubted_noise = noise.copy()
                doubted_noise[: self._n_channel] *= squared / self._n_channel
                kf.x, kf.P = before_x, before_P
                self._correct(values, at, rows, doubted_noise)
        self._judge.note(squared / rows, jolted, doubted)

    def _correct(self, values: Floats, at: Floats, rows: int, noise: Floats) -> float:
        """Take in readings, linearised in the state ``at``; return the innovation's squared size."""
        observe(self._of, self._room, at, self._predicted[: self._n_channel], self._slope)
        self._predicted[self._n_channel :] = at[1 : 3 * self._n : 3]
        return self._kf.correct(values, self._slope[:rows], self._predicted[:rows], at, noise)

    def _first_window(self, first: Floats) -> bool:
        """Judge the first readings, before any is taken in."""
        cells = self._window.cells
        if len(first) < len(cells) * self._cell:
            return False
        means = first[: len(cells) * self._cell].reshape(len(cells), self._cell, -1).mean(axis=1)
        cells[:] = means - np.where(self._coupled, self._kf.x[self._offsets], 0.0)
        return self._unrest() < 1.0

    def _close_cell(self) -> None:
        cells = self._window.cells
        cells[self._cells % len(cells)] = self._total / self._cell
        self._total[:] = 0.0
        self._in_cell, self._cells = 0, self._cells + 1
        if self._cells >= len(cells):
            share = self._unrest()
            self._settle(share < 1.0)
            self.resting = share < (TO_LEAVE if self.resting else 1.0)

    def _settle(self, still: bool) -> None:
        if still and not self._still:
            self._rest_at = at_rest(self._kf.x, self._n)
        if still:
            speeds = np.arange(self._n_channel, self._n_channel + self._n)
            self._rest_noise[speeds, speeds] = rest_variance(self._hidden, self._dt)
        self._still = still

    def _unrest(self) -> float:
        oldest = self._cells % len(self._window.cells)
        return unrest(self._of, self._room, self._window, oldest, self._kf.x, self._kf.P, self._hidden)
