"""A recording linearised along a motion: all that a pass of the smoother needs."""

from typing import NamedTuple

from arm.model import Floats
from tracking.model.course import Course
from tracking.model.expected_readings import Room, room_of
from tracking.model.observation import Observation
from tracking.smoother.smoothed import mend
from tracking.smoother.smoothing_pass import Pass, pass_of, smooth_once


class Linearised(NamedTuple):
    """A recording linearised along a motion.

    Attributes
    ----------
    of : Observation
    course : Course
    at : (n, n_state)
        The motion.
    x0, P0 : (n_state,), (n_state, n_state)
        Before the first reading.
    """

    of: Observation
    course: Course
    at: Floats
    x0: Floats
    P0: Floats

    @property
    def n_joint(self) -> int:
        """Joints of the arm."""
        return self.course.push.size

    @property
    def room(self) -> Room:
        """Room to observe in."""
        return room_of(self.n_joint)

    def smoothed(self, with_variance: bool = True) -> tuple[Pass, Floats, Floats]:
        """Return what a pass finds, and state and covariance after the last reading."""
        x, P = self.x0.copy(), self.P0.copy()
        found = pass_of(self.of, self.course, len(x))
        smooth_once(self.of, self.room, self.course, self.at, x, P, found, with_variance)
        mend(found.variance)
        return found, x, P

    def angles_of(self, found: Pass) -> Floats:
        """Return the angles of a pass, (n, n_joint)."""
        return found.states[:, : 3 * self.n_joint : 3]

    def angle_variance_of(self, found: Pass) -> Floats:
        """Return the variance that a pass claims of the angles, (n, n_joint)."""
        return found.variance[:, : 3 * self.n_joint : 3]
