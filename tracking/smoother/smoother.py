"""Joint motion from a whole recording at once: every reading counts for every instant.

A fixed-interval smoother, iterated: each pass linearises the readings along the motion that the pass before found,
which is Gauss and Newton's method for the most probable motion (B. M. Bell, *The iterated Kalman smoother as a
Gauss-Newton method*, 1994). The first passes go in coarser steps, since only their motion is wanted.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from limbcal.errors import DataError
from tracking.kalman.angle_unwrapping import unwound
from tracking.kalman.forward_filter import filter_all
from tracking.kalman.kalman_step import predict
from tracking.model.clocks import ClockSearch
from tracking.model.course import Course, course_of
from tracking.model.expected_readings import room_of
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.observation import Observation, channels_alike, observation_of, other_clocks
from tracking.model.process_noise import SMOOTHER_PUSH_STD, alarm_limit
from tracking.model.readings import Readings
from tracking.model.regression_calibration import acceleration_noise, calm
from tracking.model.zero_velocity import WINDOW_S, window_frames, window_of
from tracking.smoother.coarsening import coarser, every, finer, stride_of
from tracking.smoother.smoothed import Smoothed, contradicted, is_near, mend
from tracking.smoother.smoothing_pass import pass_of, smooth_once
from tracking.smoother.step_control import StepControl
from tracking.smoother.windows import LOOK_AHEAD_S

#: Passes at the most; the result then says that it has not converged.
_PASSES = 30
#: An alternative model, accepted only if it explains the readings, is rejected after this many passes that do not
#: converge and whose residual exceeds the sensors' noise; a convention.
_IN_VAIN = 4
#: An alternative model is rejected if the filter doubts more than this part of the instants: no robust estimate
#: can tell outliers from readings where outliers are the majority (breakdown point; P. J. Huber 1981).
_BREAKDOWN_SHARE = 0.5
#: By how long a motion may have begun before it is seen, however slowly it does: half a rest's window [s].
RELEASE_S = 0.5 * WINDOW_S
NO_MOTION = (
    "no motion of this arm explains the readings at all; expected an arm file with these joints and its sensors "
    "where they are"
)


class Smoother:
    """Smooths a recording.

    Parameters
    ----------
    arm : Arm
    q : (n_joint,)
        Where the arm rests when the recording begins.
    given : bool
        Somebody measured ``q``, see `tracking.model.initial_state.start_state`.
    mounting : MountingPrior, optional
        Estimate scale, misalignment and place of every sensor too, which are held to be no further off than this.
    clocks : bool
        Estimate by how much each sensor is later than the first one.
    """

    def __init__(
        self, arm: Arm, q: Floats, given: bool, mounting: MountingPrior | None = None, clocks: bool = False
    ) -> None:
        sought = mounting is not None or arm.sensor_covariance is not None
        self.observation, self.size = observation_of(arm, sought, clocks=other_clocks(arm) if clocks else ())
        self._arm, self._q, self._given = arm, q, given
        self._mounting = MountingPrior() if mounting is None else mounting

    def smooth(
        self,
        readings: Readings,
        fine: bool = True,
        known: Smoothed | None = None,
        start: tuple[Floats, Floats] | None = None,
        progress: Callable[[int], None] | None = None,
        previous: Smoothed | None = None,
        until: int | None = None,
        explaining: bool = False,
    ) -> Smoothed:
        """Return the most probable motion.

        Parameters
        ----------
        readings : Readings
        fine : bool
            Give every frame; otherwise one in four, which is all that constants need.
        known : Smoothed, optional
            Of an earlier recording with the same sensors: what it says of them and of the lengths is held.
        start : state and covariance, optional
            Before the first reading, where an earlier recording ended in the same rest.
        progress : callable, optional
            Told the number of passes after each.
        previous : Smoothed, optional
            Of the recording that this one follows at once, in whatever motion.
        until : int, optional
            The frame before which the state is wanted that another recording goes on from; by default the last.
        explaining : bool
            The motion is wanted only if it explains the readings: give up once it is seen not to, maybe after the
            first seconds.

        Raises
        ------
        DataError
            If no motion of the arm explains the readings at all.
        """
        x0, P0 = self._before(readings, known, start, previous)
        begin = x0
        if start is None and previous is None and not readings.begins_steadily:
            # a filter that knew neither how the arm moved nor where it was would doubt what it reads
            some = replace(readings, values=readings.values[: round(LOOK_AHEAD_S / readings.dt_s)])
            first = self._smooth(some, x0.copy(), P0, x0, False, None, None, explaining, False)
            if explaining and contradicted(self.observation, first.course, first.found):
                return replace(first, converged=False)  # what does not explain a part explains no whole
            begin = first.states[0]
        return self._smooth(readings, x0, P0, begin, fine, progress, until, explaining)

    def _smooth(
        self,
        readings: Readings,
        x0: Floats,
        P0: Floats,
        begin: Floats,
        fine: bool,
        progress: Callable[[int], None] | None,
        until: int | None,
        explaining: bool,
        started: bool = True,
    ) -> Smoothed:
        """Return the most probable motion, with the rests, jolts and doubts of a filter that begins somewhere.

        Of a filter that did not begin where the arm was, ``started`` is False: its doubts say nothing of the arm.
        """
        of, arm, n = self.observation, self._arm, self._arm.n_joint
        course = course_of(readings, n)
        clocks = ClockSearch(of, course.readings)  # they are of each recording
        clocks.begin(x0, P0)
        course = clocks.moved(course)
        states, still, resting = self._filter(course, readings, begin, P0)
        release(course, still)
        course = course._replace(push=np.full(n, SMOOTHER_PUSH_STD**2))
        stride = stride_of(course.dt)
        coarse, at = coarser(course, stride), every(states, stride)
        if (turned := unwound(at, coarse, arm, long_too=True)) is not None:
            at = turned
        steps = StepControl()
        in_vain = _IN_VAIN if explaining and started and _doubted(course) > _BREAKDOWN_SHARE else 0
        room, found = room_of(n), pass_of(of, coarse, self.size)
        noise = acceleration_noise(of, room, coarse, at)
        while steps.passes < _PASSES and not steps.converged and in_vain < _IN_VAIN:
            x, P = x0.copy(), P0.copy()
            along = calm(at, noise, coarse.dt)
            cost = smooth_once(of, room, coarse, along, x, P, found, False)
            smoothed = found.states
            if not np.isfinite(smoothed).all():
                raise DataError(NO_MOTION)
            std = np.sqrt(np.maximum(np.diag(P), 1e-12))
            if steps.judge(float((np.abs(smoothed - at).max(axis=0) / std).max()), cost):
                in_vain += explaining and contradicted(of, coarse, found)
            at = at + steps.step * (smoothed - at)
            if (turned := unwound(at, coarse, arm)) is not None:
                at = turned
                steps.begin_anew()
            if clocks.take(x, P, x0, at):
                course = clocks.moved(course)
                coarse = coarser(course, stride)
                steps.go_on()
            if progress is not None:
                progress(steps.passes)
        along, last = calm(at, noise, coarse.dt), coarse
        if fine:
            along = finer(along, len(states), stride)
            found, last = pass_of(of, course, self.size), course
        x, P = x0.copy(), P0.copy()
        smooth_once(of, room, last, along, x, P, found, True)
        at = found.states
        near, late = is_near(of, x - x0, P0), clocks.found(x, P)
        if until is not None:
            x, P = state_before(until, of, last, along, x0, P0)
        mend(found.variance)
        return Smoothed(
            at,
            found,
            x,
            P,
            P0,
            still,
            resting,
            _doubted(course),
            steps.passes,
            steps.converged,
            last,
            along,
            None,
            near,
            late,
            alike=tuple(channels_alike(of)),
        )

    def _before(
        self,
        readings: Readings,
        known: Smoothed | None,
        start: tuple[Floats, Floats] | None,
        previous: Smoothed | None,
    ) -> tuple[Floats, Floats]:
        x, P = self.begin(readings) if start is None else (start[0].copy(), start[1].copy())
        if known is not None:
            lasting = slice(3 * self._arm.n_joint, None)
            x[lasting], P[lasting, lasting] = known.final[lasting], known.covariance[lasting, lasting]
        if previous is not None:
            previous.continued(x, P)
        return x, P

    def begin(self, readings: Readings) -> tuple[Floats, Floats]:
        """Return state and covariance before the first reading of a recording."""
        return start_state(
            self._arm, self.observation, self.size, readings.first, self._q, self._given, self._mounting
        )

    def _filter(
        self, course: Course, readings: Readings, x0: Floats, P0: Floats
    ) -> tuple[Floats, NDArray[np.bool_], NDArray[np.bool_]]:
        cell, n_cell = window_frames(readings.dt_s)
        cell_noise = readings.noise.of_mean(readings.factor * cell)
        window = window_of(n_cell, self.size, cell_noise, readings.noise.rounding)
        states = np.empty((len(readings.values), self.size))
        still, resting = np.zeros((2, len(states)), dtype=np.bool_)
        limit = alarm_limit(len(course.noise))
        room = room_of(self._arm.n_joint)
        of = self.observation
        try:
            filter_all(of, room, course, window, cell, limit, x0.copy(), P0.copy(), states, still, resting)
        except np.linalg.LinAlgError as error:  # a covariance without sense, as a compiled inverse sees it
            raise DataError(NO_MOTION) from error
        if not np.isfinite(states).all():
            raise DataError(NO_MOTION)
        return states, still, resting


def _doubted(course: Course) -> float:
    """Return the share of the instants at which readings are doubted."""
    return float(np.mean((course.doubt > 1.0).any(axis=1)))


def state_before(
    frame: int, of: Observation, course: Course, along: Floats, x0: Floats, P0: Floats
) -> tuple[Floats, Floats]:
    """Return state and covariance at a frame but before its reading, from those before the first reading."""
    part = course._replace(
        readings=course.readings[:frame],
        present=course.present[:frame],
        jolt=course.jolt[:frame],
        doubt=course.doubt[:frame],
        rest=course.rest[:frame],
        drift=course.drift[:frame],
    )
    x, P = x0.copy(), P0.copy()
    room = room_of(course.push.size)
    smooth_once(of, room, part, along[:frame], x, P, pass_of(of, part, len(x)), False)
    predict(of, course, frame, x, P)
    return x, P


def release(course: Course, still: NDArray[np.bool_]) -> None:
    """Let go of an arm some time before it is seen to move: it had begun to, and its velocity was not zero.

    A rest is judged in cells, and a filter learns of the motion's beginning when the cell that it lies in is over.
    Looking back costs next to nothing: a rest that ended so much earlier says as much of the offsets.
    """
    back = round(RELEASE_S / course.dt)
    for end in np.flatnonzero(still[:-1] & ~still[1:]) + 1:
        still[max(0, end - back) : end] = False
        course.rest[max(0, end - back) : end] = 0.0
