"""Joint motion from a recording of an arm that is not quite the one in its file, on a base that may move.

What the model lacks of the readings is learnt with the motion (`tracking.discrepancy`). Whether the base moves,
and for how long what is lacking lasts, is chosen by the likelihood of the readings. The first motion is one for
which little but gravity is believed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from arm.model import Arm, Floats
from limbcal.errors import DataError
from tracking.calm_motion import acceleration_noise, calm
from tracking.clocks import ClockSearch, moved_back
from tracking.coarsening import coarser, every, finer, stride_of
from tracking.course import Course, course_of
from tracking.discrepancy import Discrepancy, noise_variances, sizes_of, with_sizes
from tracking.expected_readings import room_of
from tracking.observation import ABSENT, Observation, observation_of
from tracking.plain_filter import filter_plainly
from tracking.process import SMOOTHER_PUSH_STD
from tracking.readings import Readings
from tracking.smoothed import SIGMAS, Smoothed, mend
from tracking.smoother import NO_MOTION
from tracking.smoothing_pass import Pass, pass_of, smooth_once
from tracking.start import MountingPrior, start_state
from tracking.winding import unwound

#: For how long what the model lacks lasts [s], half a decade apart: from a stroke to a step of a walk.
MEMORIES_S = (0.03, 0.1, 0.3)
#: Log-odds at which the base is held to move: a hundred to one.
_ODDS_NATS = float(np.log(100.0))
#: Expectations and maximisations at the most, and passes in each.
_ROUNDS, _PASSES = 30, 4
#: Rounds end when no size changes by more than this share; passes when no joint does by more than this [rad or m].
_CLOSE_ENOUGH, _SETTLED = 0.02, 1e-3
#: A pass moves no joint by more than this [rad or m]: further away slopes say little.
_LONGEST_STEP = 0.5
#: Speed of a joint before anything is known of it [rad/s or m/s]; over how long motion averages out [s].
_USUAL_SPEED, _SLOW_S = 1.0, 1.0
#: A speed's size below this is none [rad/s or m/s].
_LEAST = 1e-3


@dataclass
class _Fit:
    """A motion with the sizes under which it is most probable."""

    of: Observation
    size: int
    course: Course
    sizes: Discrepancy
    start: tuple[Floats, Floats]
    found: Pass
    final: tuple[Floats, Floats]
    rounds: int
    converged: bool
    log_likelihood: float
    clocks: ClockSearch


class _Begin(NamedTuple):
    """A motion that sizes are sought from, and by how much readings depart from it.

    ``states`` (n, n_state) of coarse frames, None for what gravity shows; ``departure`` [m/s^2].
    """

    states: Floats | None
    departure: float


class DiscrepancySmoother:
    """Smooths a recording, and learns what its model lacks.

    Parameters
    ----------
    arm, q, given, mounting
        As of `tracking.smoother.Smoother`.
    """

    def __init__(self, arm: Arm, q: Floats, given: bool, mounting: MountingPrior | None = None) -> None:
        self._arm, self._q, self._given = arm, q, given
        self._sought = mounting is not None or arm.sensor_covariance is not None
        self._mounting = MountingPrior() if mounting is None else mounting
        self._revolute = np.array([joint.type == "revolute" for joint in arm.joints])
        self.observation, self.size = observation_of(arm, self._sought)

    def smooth(
        self,
        readings: Readings,
        exact: Smoothed | None = None,
        known: Smoothed | None = None,
        progress: Callable[[int], None] | None = None,
    ) -> Smoothed:
        """Return the most probable motion.

        Parameters
        ----------
        readings : Readings
        exact : Smoothed, optional
            The motion of an exact arm, if there is one: its rests are held, and it is a second one to begin with.
        known : Smoothed, optional
            Of an earlier recording with the same sensors: what it says of them and of the lengths is held, and
            whether the base moves.
        progress : callable, optional
            Told the number of rounds after each.


        Raises
        ------
        DataError
            If no motion of the arm explains the readings at all.
        """
        n = self._arm.n_joint
        course = course_of(readings, n)._replace(push=np.full(n, SMOOTHER_PUSH_STD**2))
        stride = stride_of(course.dt)
        begins = [_Begin(None, _departure(course))]
        if exact is not None:
            course = course._replace(rest=_rest_at_every_frame(exact, course))
            states = exact.states if exact.course.dt > readings.dt_s else every(exact.states, stride)
            begins.append(_Begin(states, float(np.sqrt(np.square(exact.residual).mean()))))
        coarse = coarser(course, stride)
        rounds = 0

        def fitted(base: bool, memory_s: float) -> _Fit:
            nonlocal rounds
            fits = [self._fitted(readings, coarse, (base, memory_s), known, begin) for begin in begins]
            best = int(np.argmax([one.log_likelihood for one in fits]))
            fit, begins[:] = fits[best], [begins[best]]  # from where the first kind is likelier, all are sought
            rounds += sum(one.rounds for one in fits)
            if progress is not None:
                progress(rounds)
            return fit

        if known is not None and known.discrepancy is not None:  # of the same arm on the same base
            sizes = known.discrepancy
            return self._smoothed(fitted(sizes.base_std > 0.0, sizes.memory_s), course, stride, rounds)
        fit = fitted(False, MEMORIES_S[1])
        if len({sensor.joint for sensor in self._arm.sensors}) > 1:  # what one link's sensors share is its own
            moving = fitted(True, MEMORIES_S[1])
            if moving.log_likelihood > fit.log_likelihood + _ODDS_NATS:
                fit = moving
        others = [fitted(fit.sizes.base_std > 0.0, memory_s) for memory_s in (MEMORIES_S[0], MEMORIES_S[2])]
        fit = max([fit, *others], key=lambda one: one.log_likelihood)
        return self._smoothed(fit, course, stride, rounds)

    def _fitted(
        self,
        readings: Readings,
        course: Course,
        kind: tuple[bool, float],
        known: Smoothed | None,
        begin: _Begin,
    ) -> _Fit:
        """Return the motion with the likeliest sizes, of one kind: whether the base moves, and for how long."""
        base, memory_s = kind
        of, size = observation_of(self._arm, self._sought, base, lack=True, clocks=True)
        start, clocks = self._begin(of, size, readings, known), ClockSearch(of, course.readings)
        clocks.begin(*start)
        course = clocks.moved(course)
        usual = begin.departure
        sizes = Discrepancy(usual, usual * base, memory_s, np.full(self._arm.n_joint, _USUAL_SPEED))
        variance = np.maximum(np.full(course.readings.shape, usual**2), course.noise)
        found = pass_of(of, course, size)
        course = with_sizes(course, sizes, variance)
        if begin.states is None:
            at = filter_plainly(of, course, *_before(of, start, sizes))
        else:
            same = self.size if begin.states.shape[1] == self.size else 3 * self._arm.n_joint + 3 * of.link.size
            at = np.hstack([begin.states[:, :same], np.zeros((len(begin.states), size - same))])
        if (turned := unwound(at, course, self._arm, long_too=True)) is not None:
            at = turned
        converged, rounds, log_likelihood = False, 0, -np.inf
        while rounds < _ROUNDS and not converged:
            at, final, log_likelihood = self._settled(of, course, at, _before(of, start, sizes), found)
            new = sizes_of(of, found, self._revolute, memory_s)
            variance, was = np.sqrt(noise_variances(course, found) * variance), variance
            moved = [np.abs(np.log(variance / was)).mean()]
            for a, b in ((new.lack_std, sizes.lack_std), (new.base_std, sizes.base_std)):
                moved += [abs(np.log(a / b))] if b > 0.0 else []
            moved += list(np.abs(np.log(np.maximum(new.speed_std, _LEAST) / np.maximum(sizes.speed_std, _LEAST))))
            if clocks.take(*final, start[0], at):
                course = clocks.moved(course)
                moved.append(np.inf)
            sizes, course = new, with_sizes(course, new, variance)
            rounds, converged = rounds + 1, max(moved) < _CLOSE_ENOUGH
        return _Fit(of, size, course, sizes, start, found, final, rounds, converged, log_likelihood, clocks)

    def _settled(
        self, of: Observation, course: Course, at: Floats, before: tuple[Floats, Floats], found: Pass
    ) -> tuple[Floats, tuple[Floats, Floats], float]:
        """Return the motion under given sizes, what is known after it, and its log-likelihood."""
        n, room = self._arm.n_joint, room_of(self._arm.n_joint)
        joints = slice(0, 3 * n, 3)
        for _ in range(_PASSES):
            x, P = before[0].copy(), before[1].copy()
            along = calm(at, acceleration_noise(of, room, course, at), course.dt)
            cost = smooth_once(of, room, course, along, x, P, found, True)
            if not np.isfinite(found.states).all():
                raise DataError(NO_MOTION)
            mend(found.variance)
            step = float(np.abs(found.states[:, joints] - at[:, joints]).max())
            at = at + min(1.0, _LONGEST_STEP / max(step, _SETTLED)) * (found.states - at)
            if (turned := unwound(at, course, self._arm)) is not None:
                at = turned
            elif step < _SETTLED:
                break
        return at, (x, P), -0.5 * cost

    def _begin(
        self, of: Observation, size: int, readings: Readings, known: Smoothed | None
    ) -> tuple[Floats, Floats]:
        first, steady = readings.first_mean, readings.begins_steadily
        x, P = start_state(self._arm, of, size, first, steady, self._q, self._given, self._mounting)
        if known is not None:
            lasting = slice(3 * self._arm.n_joint, self.size)  # clocks are of each recording
            x[lasting], P[lasting, lasting] = known.final[lasting], known.covariance[lasting, lasting]
        return x, P

    def _smoothed(self, fit: _Fit, course: Course, stride: int, rounds: int) -> Smoothed:
        """Return the motion at every frame."""
        of, before = fit.of, _before(fit.of, fit.start, fit.sizes)
        if stride > 1:
            each = np.minimum(np.arange(len(course.readings)) // stride, len(fit.course.doubt) - 1)
            variance = (fit.course.noise * fit.course.doubt * stride)[each]
            course = with_sizes(course, fit.sizes, np.maximum(variance, course.noise))
            course = moved_back(course, course.readings, fit.clocks.late_s)
            at = finer(fit.found.states, len(course.readings), stride)
        else:
            course, at = fit.course, fit.found.states
        found = pass_of(of, course, fit.size)
        x, P = before[0].copy(), before[1].copy()
        smooth_once(of, room_of(self._arm.n_joint), course, at, x, P, found, True)
        mend(found.variance)
        still = np.any(course.rest > 0.0, axis=1)
        own = slice(0, self.size)
        # where noise is larger than what the sensor's own hardly ever is
        doubted = float(np.mean(course.doubt[course.present] > SIGMAS**2))
        return Smoothed(
            found.states[:, own],
            found,
            x[own],
            P[own, own],
            before[1][own, own],
            still,
            still,
            doubted,
            rounds,
            fit.converged,
            course,
            at,
            fit.sizes,
            clocks=fit.clocks.found(x, P),
        )


def _rest_at_every_frame(exact: Smoothed, course: Course) -> Floats:
    """Return the variance with which joints were held to rest, (n, n_joint)."""
    stride = round(exact.course.dt / course.dt)
    each = np.minimum(np.arange(len(course.readings)) // stride, len(exact.course.rest) - 1)
    rest: Floats = stride * exact.course.rest[each]
    return rest


def _departure(course: Course) -> float:
    """Return by how much the readings depart from their own mean over a second [m/s^2]."""
    window = max(1, round(_SLOW_S / course.dt))
    readings = course.readings[course.present]
    departure = readings - uniform_filter1d(readings, min(window, len(readings)), axis=0)
    return max(float(np.sqrt(np.square(departure).mean())), float(np.sqrt(course.noise.max())))


def _before(of: Observation, start: tuple[Floats, Floats], sizes: Discrepancy) -> tuple[Floats, Floats]:
    """Return state and covariance before the first reading."""
    x, P = start[0].copy(), start[1].copy()
    for first, count, std in (
        (of.base_column, 3, sizes.base_std),
        (of.lack_column, 3 * of.link.size, sizes.lack_std),
    ):
        if first != ABSENT:
            at = np.arange(first, first + count)
            P[at, at] = std**2
    return x, P
