"""Expectation and maximisation: a motion, and the sizes of what the model lacks under which it is most probable.

Sizes of one kind are sought from one motion to begin with: whether the base moves, and for how long what is
lacking lasts. Several such searches race: one is given up when even gains as large as its last one, in all the
rounds that it has left, would not bring it to the best.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from arm.model import Arm, Floats
from limbcal.errors import DataError
from tracking.kalman.angle_unwrapping import unwound
from tracking.kalman.plain_filter import filter_plainly
from tracking.model.clocks import ClockSearch
from tracking.model.course import Course
from tracking.model.discrepancy import Discrepancy, with_sizes
from tracking.model.expected_readings import room_of
from tracking.model.observation import ABSENT, Observation, channels_alike, rms_alike
from tracking.model.regression_calibration import acceleration_noise, calm
from tracking.smoother.discrepancy_sizes import noise_variances, sizes_of
from tracking.smoother.linearised import Linearised
from tracking.smoother.smoothed import mend
from tracking.smoother.smoother import NO_MOTION
from tracking.smoother.smoothing_pass import pass_of, smooth_once

#: Expectations and maximisations at the most, and passes in each; variances are wanted of the last.
_ROUNDS, _PASSES = 30, 4
#: Rounds once clocks are let go: all else is where it was found to be.
_LAST_ROUNDS = 5
#: Rounds end when one gains less than this [nats], an odds ratio of a hundred.
_LEAST_GAIN = float(np.log(100.0))
#: Passes end when no joint moves by more than this [rad or m].
_SETTLED = 1e-3
#: A pass moves no joint by more than this [rad or m]: further away slopes say little.
_LONGEST_STEP = 0.5
#: Speed of a joint before anything is known of it [rad/s or m/s]; over how long motion averages out [s].
_USUAL_SPEED, _SLOW_S = 1.0, 1.0


class Begin(NamedTuple):
    """A motion that sizes are sought from, and by how much readings depart from it.

    ``states`` (n, n_state) of coarse frames, None for what gravity shows; ``departure`` (n_channel,).
    """

    states: Floats | None
    departure: Floats


class DiscrepancyFit:
    """A motion with the sizes under which it is most probable, bettered round by round.

    Parameters
    ----------
    arm : Arm
    of, size
        As from `tracking.model.observation.observation_of`, with what is lacking, and the base if that moves.
    course : Course
        Coarse frames.
    memory_s : float
        For how long what is lacking lasts.
    start : state and covariance
        Before the first reading.
    begin : Begin
    n_own : int
        States before those that are sought here only.

    Attributes
    ----------
    log_likelihood : float
        Of the readings, under the sizes of the last round but one [nats].
    rounds : int
    converged : bool
    """

    def __init__(
        self,
        arm: Arm,
        of: Observation,
        size: int,
        course: Course,
        memory_s: float,
        start: tuple[Floats, Floats],
        begin: Begin,
        n_own: int,
    ) -> None:
        self.of, self.size, self.start, self._arm = of, size, start, arm
        self._revolute = np.array([joint.type == "revolute" for joint in arm.joints])
        self.clocks = ClockSearch(of, course.readings)
        usual = begin.departure
        moves = of.base_column != ABSENT
        lacks = [float(usual[part.start]) for part in channels_alike(of)]
        speeds = np.full(arm.n_joint, _USUAL_SPEED)
        self.sizes = Discrepancy(lacks[0], lacks[0] * moves, memory_s, speeds, *lacks[1:])
        self._variance = np.maximum(np.tile(usual**2, (len(course.readings), 1)), course.noise)
        self.found = pass_of(of, course, size)
        self.course = with_sizes(of, course, self.sizes, self._variance)
        if begin.states is None:
            at = filter_plainly(of, self.course, *before(of, start, self.sizes))
        else:
            same = n_own if begin.states.shape[1] == n_own else 3 * arm.n_joint + 3 * of.link.size
            at = np.hstack([begin.states[:, :same], np.zeros((len(begin.states), size - same))])
        turned = unwound(at, self.course, arm, long_too=True)
        self._at = at if turned is None else turned
        self.rounds, self.converged, self.log_likelihood = 0, False, -np.inf
        self._gain, self._last_gain = np.inf, np.inf

    @property
    def is_done(self) -> bool:
        """Whether no round is left."""
        return self.converged or self.rounds == _ROUNDS

    @property
    def limit(self) -> float:
        """The log-likelihood that rounds without end would come to, by Aitken's extrapolation [nats]."""
        ratio = self._gain / self._last_gain if self._last_gain else 0.0
        return self.log_likelihood + (self._gain * ratio / (1.0 - ratio) if 0.0 < ratio < 1.0 else 0.0)

    @property
    def most_log_likelihood(self) -> float:
        """The log-likelihood after all rounds if each gained as much as the last one [nats]."""
        return self.log_likelihood + (0.0 if self.is_done else (_ROUNDS - self.rounds) * abs(self._gain))

    def advance(self) -> None:
        """Make one round.

        Raises
        ------
        DataError
            If no motion of the arm explains the readings at all.
        """
        was = self.log_likelihood
        final = self._settle()
        self._gain, self._last_gain = self.log_likelihood - was, self._gain
        self.sizes = sizes_of(self.of, self.found, self._revolute, self.sizes.memory_s)
        late = self.clocks.take(*final, self.start[0], self._at)
        if late:
            self.course = self.clocks.moved(self.course)
        self._variance = np.sqrt(noise_variances(self.of, self.course, self.found) * self._variance)
        self.course = with_sizes(self.of, self.course, self.sizes, self._variance)
        self.rounds, self.converged = self.rounds + 1, not late and abs(self._gain) < _LEAST_GAIN

    def let_go(self, of: Observation, size: int, start: tuple[Floats, Floats]) -> None:
        """Let some clocks differ, and go on from the motion and the sizes that were found.

        Parameters
        ----------
        of, size, start
            With these clocks, else as before.
        """
        self.of, self.size, self.start = of, size, start
        self.clocks = ClockSearch(of, self.course.readings)
        self.clocks.begin(*start)
        self.course = self.clocks.moved(self.course)
        self.found = pass_of(of, self.course, size)
        columns = np.unique(of.clock_column[of.clock_column != ABSENT])
        self._at = np.insert(self._at, np.full(len(columns), columns[0]), 0.0, axis=1)
        self.rounds, self.converged = _ROUNDS - _LAST_ROUNDS, False
        self._gain, self._last_gain = np.inf, np.inf

    @property
    def linearised(self) -> Linearised:
        """The recording along the motion, under the present sizes."""
        along = calm(
            self._at,
            acceleration_noise(self.of, room_of(self._arm.n_joint), self.course, self._at),
            self.course.dt,
        )
        return Linearised(self.of, self.course, along, *before(self.of, self.start, self.sizes))

    def _settle(self) -> tuple[Floats, Floats]:
        """Find the motion under given sizes and its log-likelihood; return what is known after it."""
        of, course, n, room = self.of, self.course, self._arm.n_joint, room_of(self._arm.n_joint)
        joints, begin, settled = slice(0, 3 * n, 3), before(of, self.start, self.sizes), False
        for k in range(_PASSES):
            is_last = settled or k == _PASSES - 1
            x, P = begin[0].copy(), begin[1].copy()
            along = calm(self._at, acceleration_noise(of, room, course, self._at), course.dt)
            self.log_likelihood = -0.5 * smooth_once(of, room, course, along, x, P, self.found, is_last)
            if not np.isfinite(self.found.states).all():
                raise DataError(NO_MOTION)
            step = float(np.abs(self.found.states[:, joints] - self._at[:, joints]).max())
            self._at = self._at + min(1.0, _LONGEST_STEP / max(step, _SETTLED)) * (self.found.states - self._at)
            if (turned := unwound(self._at, course, self._arm)) is not None:
                self._at = turned
            if is_last:
                break
            settled = turned is None and step < _SETTLED  # one more, for the variances
        mend(self.found.variance)
        return x, P


def likeliest(
    fits: Sequence[DiscrepancyFit], against: Sequence[float], progress: Callable[[], None]
) -> DiscrepancyFit:
    """Return the likeliest of some fits after all its rounds; the others are given up when they cannot be it.

    Parameters
    ----------
    fits : sequence of DiscrepancyFit
    against : sequence of float
        Logarithm of the prior odds against each [nats].
    progress : callable
        Called after every round.
    """
    racing = list(zip(fits, against, strict=True))
    while not all(fit.is_done for fit, _ in racing):
        for fit, _ in racing:
            if not fit.is_done:
                fit.advance()
                progress()
        best = max(fit.log_likelihood - odds for fit, odds in racing)
        racing = [(fit, odds) for fit, odds in racing if fit.most_log_likelihood - odds >= best]
    return max(racing, key=lambda one: one[0].limit - one[1])[0]


def departure(of: Observation, course: Course) -> Floats:
    """Return by how much the readings depart from their own mean over a second, alike for a kind, (n_channel,)."""
    window = max(1, round(_SLOW_S / course.dt))
    readings = course.readings[course.present]
    off = readings - uniform_filter1d(readings, min(window, len(readings)), axis=0)
    loudest = [np.full(part.stop - part.start, course.noise[part].max()) for part in channels_alike(of)]
    most: Floats = np.maximum(rms_alike(of, off), np.sqrt(np.concatenate(loudest)))
    return most


def before(of: Observation, start: tuple[Floats, Floats], sizes: Discrepancy) -> tuple[Floats, Floats]:
    """Return state and covariance before the first reading."""
    x, P = start[0].copy(), start[1].copy()
    for first, count, std in (
        (of.base_column, 3, np.full(3, sizes.base_std)),
        (of.lack_column, 3 * of.link.size, sizes.lack_stds(of)),
    ):
        if first != ABSENT:
            at = np.arange(first, first + count)
            P[at, at] = std**2
    return x, P
