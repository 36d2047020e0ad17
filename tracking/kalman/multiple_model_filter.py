"""A motion found again after a gap: which way an arm turns, no single instant shows.

An accelerometer feels a link's angular velocity only by `omega x (omega x r)`, the same for both ways round; so a
filter that begins anew within a motion may begin with the wrong one, and then explains by jolt after jolt why
the speed does not change as the accelerations say. After a gap that is too long to be predicted, each way that
explains the first reading is followed by a filter of its own, until what comes contradicts the others.
"""

import copy
import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from tracking.kalman.batch_filter import Course, joined
from tracking.kalman.restarted_filter import RestartedFilter
from tracking.model.innovation_test import Consistency
from tracking.model.noise import Noise

#: Speeds at which a search for what explains readings begins, either way: of the first joint, and times more of
#: each that follows, so that every link is begun with either way round [rad/s or m/s].
_FIRST_SPEED, _TIMES = 0.5, 2.2
#: Joints that are begun either way, at the most: 64 beginnings.
_MOST_JOINTS = 6
#: Gauss-Newton steps of such a search; a convention.
_STEPS = 12
#: Speeds that differ by no more are the same way [rad/s or m/s]: about a degree a second, a convention.
_SAME = 0.02
#: So much worse, by the squared misfit, and a way is contradicted: by chance once in 10^9.
_CONTRADICTED = 40.0
#: The first reading shows speeds through noise; the mean of those in the first moments is asked again [s].
_MOMENT_S = 0.032
#: As many ways are followed at the most, for so long, and so often it is asked which is the best [frames].
_MOST_WAYS, _FOLLOWED_S, _SPAN = 8, 3.0, 10


class MultipleModelFilter:
    """A live filter that takes in many readings and finds the motion again after gaps.

    Parameters are those of `tracking.kalman.live_filter.LiveFilter`.
    """

    def __init__(
        self, arm: Arm, q: Floats, given: bool, first: Floats, noise: Noise, factor: int, dt_s: float
    ) -> None:
        self._filter = RestartedFilter(arm, q, given, first, noise, factor, dt_s)
        self._rivals: list[RestartedFilter] = []
        self._n, self._dt = arm.n_joint, dt_s
        self._moment, self._most = max(1, round(_MOMENT_S / dt_s)), round(_FOLLOWED_S / dt_s)
        self._lost = self._filter
        self._seen: list[Floats] = []
        self._followed = 0

    def follow(self, readings: Floats) -> Course:
        """Take in readings, (n, n_channel), and say what came of each; those of a lost frame are NaN."""
        some_lost = math.isnan(sum(readings[:, 0].tolist()))
        if not (self._rivals or self._filter.loss.lost or some_lost):  # as nearly always
            return self._filter.follow(readings)
        parts = []
        for part in _stretches(np.isnan(readings[:, 0])):
            left = readings[part]
            if np.isnan(left[0, 0]):
                self._rivals = []
            elif self._filter.loss.lost:
                self._lost, self._seen, self._followed = self._filter, [], 0
                self._rivals = self._ways(left[:1])
                self._filter = self._rivals[0]
            while self._rivals and len(left):
                span = self._to_decision()
                parts.append(self._compete(left[:span]))
                left = left[span:]
            if len(left):
                parts.append(self._filter.follow(left))
        return joined(parts)

    def skip(self, frames: int) -> None:
        """Let lost frames go by that nobody asks for."""
        self._filter.loss.skip(frames)

    def retime(self, dt_s: float) -> None:
        """Go on with another time from frame to frame."""
        for one in [*self._rivals, self._lost] if self._rivals else [self._filter]:
            one.retime(dt_s)

    def learn(self, noise: Noise) -> None:
        """Go on with what is now known of the noise of a sample."""
        for one in [*self._rivals, self._lost] if self._rivals else [self._filter]:
            one.learn(noise)

    def consistency(self) -> Consistency:
        """Return how well the readings since the last call fit the filter's claims."""
        return self._filter.consistency()

    def strain(self) -> float:
        """Return the mean square of the innovations since the last call, none larger than noise makes it."""
        return self._filter.strain()

    @property
    def state(self) -> tuple[Floats, Floats]:
        """State and covariance."""
        return self._filter.state

    def begin_anew(self, x: Floats, P: Floats) -> None:
        """Go on from another state and covariance."""
        self._rivals = []
        self._filter.begin_anew(x, P)

    def _to_decision(self) -> int:
        """Return in how many frames it is next asked which way is the best, however readings come."""
        span = _SPAN - self._followed % _SPAN
        return min(span, self._moment - self._followed) if self._followed < self._moment else span

    def _compete(self, readings: Floats) -> Course:
        """Let all that are left take in readings; return what the one makes of them that was the best before."""
        decides = len(readings) == self._to_decision()
        courses = {rival: rival.follow(readings) for rival in self._rivals}
        course = courses[self._filter]
        self._followed += len(readings)
        if self._followed <= self._moment:
            self._seen.extend(readings)
        if self._followed == self._moment:
            self._rivals = self._ways(np.array(self._seen))
        if decides:
            self._rivals.sort(key=lambda rival: rival.misfit)
            self._filter = self._rivals[0]
        if decides and self._followed >= self._moment:
            self._rivals = [] if self._followed >= self._most else self._still_possible()
        return course

    def _still_possible(self) -> list[RestartedFilter]:
        """Return the rivals that nothing contradicts, best first, one of each way; none where it is decided."""
        left: list[RestartedFilter] = []
        for rival in self._rivals:
            near = rival.misfit - self._filter.misfit < _CONTRADICTED
            if near and not any(self._alike(rival.x, one.x) for one in left):
                left.append(rival)
        return left if len(left) > 1 else []

    def _ways(self, readings: Floats) -> list[RestartedFilter]:
        """Return a filter for each way that explains readings right after a gap, and has taken them in."""
        regained = copy.deepcopy(self._lost)
        regained.regain(readings)
        found: list[tuple[Floats, float]] = []
        for begin in self._beginnings(regained.x):
            at, squared = _explained(regained, readings, begin)
            if np.isfinite(squared) and not any(self._alike(at, one) for one, _ in found):
                found.append((at, squared))
        if not found:  # no motion of this arm explains them at all, which is the filter's to say
            return [regained]
        found.sort(key=lambda one: one[1])
        rivals = []
        for at, _ in found[:_MOST_WAYS]:
            rival = copy.deepcopy(regained)
            rival.suppose(readings, at)
            rivals.append(rival)
        return rivals

    def _alike(self, one: Floats, other: Floats) -> bool:
        """Say whether joints move alike in two states."""
        speeds = slice(1, 3 * self._n, 3)
        return bool(np.abs(one[speeds] - other[speeds]).max() < _SAME)

    def _beginnings(self, state: Floats) -> Iterator[Floats]:
        """Yield a state with each joint turning either way."""
        turning = min(self._n, _MOST_JOINTS)
        speeds = _FIRST_SPEED * _TIMES ** np.arange(turning)
        for ways in itertools.product((1.0, -1.0), repeat=turning):
            x = state.copy()
            x[1 : 3 * turning : 3] = speeds * ways
            yield x


def _explained(rival: RestartedFilter, readings: Floats, at: Floats) -> tuple[Floats, float]:
    """Return the state, found from one on, in which readings are explained best, and their misfit."""
    squared = np.inf
    try:
        for _ in range(_STEPS):
            at, squared = rival.explained(readings, at)
    except np.linalg.LinAlgError:
        return at, np.inf
    return at, squared


def _stretches(flags: NDArray[np.bool_]) -> Iterator[slice]:
    """Yield the stretches in which flags are the same."""
    ends = [*(np.flatnonzero(np.diff(flags)) + 1).tolist(), len(flags)]
    begin = 0
    for end in ends:
        yield slice(begin, end)
        begin = end
