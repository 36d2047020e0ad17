"""Joint motion from a recording of an arm that is not quite the one in its file, on a base that may move.

What the model lacks of the readings is learnt with the motion (`tracking.model.discrepancy`). Whether the base
moves, and for how long what is lacking lasts, is chosen by the likelihood of the readings. The first motion is one
for which little but gravity is believed.
"""

from collections.abc import Callable
from copy import copy
from typing import NamedTuple

import numpy as np

from arm.model import Arm, Floats
from tracking.model.clocks import moved_back
from tracking.model.course import Course, course_of
from tracking.model.discrepancy import with_sizes
from tracking.model.expected_readings import room_of
from tracking.model.gravity_length import bound_offsets
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.observation import Observation, observation_of, other_clocks, rms_alike
from tracking.model.process_noise import SMOOTHER_PUSH_STD
from tracking.model.readings import Readings
from tracking.smoother.clock_evidence import accepted, effect_slopes
from tracking.smoother.coarsening import coarser, every, finer, stride_of
from tracking.smoother.consider_covariance import STRETCH_MEMORIES, Considered, consider
from tracking.smoother.discrepancy_fit import Begin, DiscrepancyFit, before, departure, likeliest
from tracking.smoother.linearised import Linearised
from tracking.smoother.sensor_disagreement import disagreement, variance_by_lack
from tracking.smoother.sensor_effects import information_of, late_and_loose
from tracking.smoother.smoothed import SIGMAS, Smoothed, mend
from tracking.smoother.smoother import state_before
from tracking.smoother.smoothing_pass import pass_of, smooth_once

#: For how long what the model lacks lasts [s], half a decade apart: from a stroke to a step of a walk.
MEMORIES_S = (0.03, 0.1, 0.3)
#: Log-odds at which the base is held to move: a hundred to one.
_ODDS_NATS = float(np.log(100.0))


class Judged(NamedTuple):
    """What a fit's claims rest on.

    Attributes
    ----------
    problem : Linearised
        The recording along the motion that was found.
    considered : Considered
    larger : (n_joint,)
        By how many times what the model lacks varies more than is held.
    """

    problem: Linearised
    considered: Considered
    larger: Floats


class DiscrepancySmoother:
    """Smooths a recording, and learns what its model lacks.

    Parameters
    ----------
    arm, q, given, mounting
        As of `tracking.smoother.smoother.Smoother`.
    """

    def __init__(self, arm: Arm, q: Floats, given: bool, mounting: MountingPrior | None = None) -> None:
        self._arm, self._q, self._given = arm, q, given
        self._sought = mounting is not None or arm.sensor_covariance is not None
        self._mounting = MountingPrior() if mounting is None else mounting
        self.observation, self.size = observation_of(arm, self._sought)
        self._housing = np.array([*range(len(arm.sensors)), *arm.gyroscopes], dtype=np.intp)

    def smooth(
        self,
        readings: Readings,
        exact: Smoothed | None = None,
        known: Smoothed | None = None,
        progress: Callable[[int], None] | None = None,
        previous: Smoothed | None = None,
        until: int | None = None,
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
        previous, until : Smoothed and int, optional
            As of `tracking.smoother.smoother.Smoother.smooth`.

        Raises
        ------
        DataError
            If no motion of the arm explains the readings at all.
        """
        n = self._arm.n_joint
        course = course_of(readings, n)._replace(push=np.full(n, SMOOTHER_PUSH_STD**2))
        stride = stride_of(course.dt)
        begins = [Begin(None, departure(self.observation, course))]
        if exact is not None:
            course = course._replace(rest=_rest_at_every_frame(exact, course))
            states = exact.states if exact.course.dt > readings.dt_s else every(exact.states, stride)
            begins.append(Begin(states, rms_alike(self.observation, exact.residual)))
        coarse, rounds = coarser(course, stride), 0

        def count_round() -> None:
            nonlocal rounds
            rounds += 1
            if progress is not None:
                progress(rounds)

        def fit(base: bool, memory_s: float, begin: Begin) -> DiscrepancyFit:
            of, size = observation_of(self._arm, self._sought, base, lack=True)
            start = self._begin(of, size, readings, known, previous)
            return DiscrepancyFit(self._arm, of, size, coarse, memory_s, start, begin, self.size)

        if known is not None and known.discrepancy is not None:  # of the same arm on the same base
            sizes = known.discrepancy
            fits = [fit(sizes.base_std > 0.0, sizes.memory_s, begin) for begin in begins]
            best = likeliest(fits, [0.0] * len(fits), count_round)
            best, judged = self._with_late_clocks(best, readings, known, previous, count_round)
            return self._smoothed(best, judged, course, stride, rounds, until)
        moves = [False, True] if len({sensor.joint for sensor in self._arm.sensors}) > 1 else [False]
        kinds = [(base, begin) for base in moves for begin in begins]  # what one link's sensors share is its own
        fits = [fit(base, MEMORIES_S[1], begin) for base, begin in kinds]
        best = likeliest(fits, [_ODDS_NATS * base for base, _ in kinds], count_round)
        base, begin = kinds[fits.index(best)]
        others = [fit(base, memory_s, begin) for memory_s in (MEMORIES_S[0], MEMORIES_S[2])]
        best = likeliest([best, *others], [0.0] * 3, count_round)
        best, judged = self._with_late_clocks(best, readings, known, previous, count_round)
        return self._smoothed(best, judged, course, stride, rounds, until)

    def _with_late_clocks(
        self,
        fit: DiscrepancyFit,
        readings: Readings,
        known: Smoothed | None,
        previous: Smoothed | None,
        count_round: Callable[[], None],
    ) -> tuple[DiscrepancyFit, Judged]:
        """Return the fit with those clocks that the readings say differ; as it is if none does."""
        asked, judged = other_clocks(self._arm), self._judged(fit)
        if not asked:
            return fit, judged
        problem, base = judged.problem, fit.sizes.base_std > 0.0
        found, course = problem.smoothed()[0], problem.course
        effects, n_channel = late_and_loose(problem, found, self._housing, asked), course.noise.size
        there = course.present[:, None]
        slopes = effect_slopes(
            found.error[:, :n_channel] * there,
            found.precision[:, :n_channel] * there,
            effects.slopes,
            information_of(problem, found, effects),
            effects.prior_std,
            max(1, round(STRETCH_MEMORIES * fit.sizes.memory_s / course.dt)),
            max(judged.considered.dispersion, judged.larger.max()),
        )
        differ = tuple(asked[k] for k in accepted(slopes) if k < len(asked))
        if not differ:
            return fit, judged
        of, size = observation_of(self._arm, self._sought, base, lack=True, clocks=differ)
        late = copy(fit)
        late.let_go(of, size, self._begin(of, size, readings, known, previous))
        late = likeliest([late], [0.0], count_round)
        return late, self._judged(late)

    def _begin(
        self, of: Observation, size: int, readings: Readings, known: Smoothed | None, previous: Smoothed | None
    ) -> tuple[Floats, Floats]:
        x, P = start_state(self._arm, of, size, readings.first, self._q, self._given, self._mounting)
        bound_offsets(of, readings, P)
        if known is not None:
            lasting = slice(3 * self._arm.n_joint, self.size)  # clocks are of each recording
            x[lasting], P[lasting, lasting] = known.final[lasting], known.covariance[lasting, lasting]
        if previous is not None:
            previous.continued(x, P)
        return x, P

    def _smoothed(
        self, fit: DiscrepancyFit, judged: Judged, course: Course, stride: int, rounds: int, until: int | None
    ) -> Smoothed:
        """Return the motion at every frame."""
        of, start = fit.of, before(fit.of, fit.start, fit.sizes)
        if stride > 1:
            each = np.minimum(np.arange(len(course.readings)) // stride, len(fit.course.doubt) - 1)
            variance = (fit.course.noise * fit.course.doubt * stride)[each]
            course = with_sizes(of, course, fit.sizes, np.maximum(variance, course.noise))
            course = moved_back(course, course.readings, fit.clocks.late_s)
            at = finer(fit.found.states, len(course.readings), stride)
        else:
            course, at = fit.course, fit.found.states
        considered = judged.considered
        more = considered.variance + np.repeat(judged.larger - 1.0, 3) * variance_by_lack(judged.problem)
        x0, P0 = considered.held(*start)
        found, room = pass_of(of, course, fit.size), room_of(self._arm.n_joint)
        x, P = x0.copy(), P0.copy()
        smooth_once(of, room, course, at, x, P, found, True)
        mend(found.variance)
        found.variance[:, : more.shape[1]] += finer(more, len(at), stride) if stride > 1 else more
        P = considered.added_to(P, judged.problem.smoothed(with_variance=False)[2])
        late = fit.clocks.found(x, P)
        if until is not None:
            x, P = state_before(until, of, course, at, x0, P0)
            P = considered.added_to(P, state_before(until, of, course, at, *start)[1])
        still = np.any(course.rest > 0.0, axis=1)
        own = slice(0, self.size)
        # where noise is larger than what the sensor's own hardly ever is
        doubted = float(np.mean(course.doubt[course.present] > SIGMAS**2))
        return Smoothed(
            found.states[:, own],
            found,
            x[own],
            P[own, own],
            start[1][own, own],
            still,
            still,
            doubted,
            rounds,
            fit.converged,
            course,
            at,
            fit.sizes,
            clocks=late,
        )

    def _judged(self, fit: DiscrepancyFit) -> Judged:
        problem = fit.linearised
        return Judged(problem, consider(problem, fit.sizes.memory_s), disagreement(problem, self._housing))


def _rest_at_every_frame(exact: Smoothed, course: Course) -> Floats:
    """Return the variance with which joints were held to rest, (n, n_joint)."""
    stride = round(exact.course.dt / course.dt)
    each = np.minimum(np.arange(len(course.readings)) // stride, len(exact.course.rest) - 1)
    rest: Floats = stride * exact.course.rest[each]
    return rest
