"""A smoothed motion: how well it is known, and whether the arm explains the readings."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from tracking.model.clocks import Clocks
from tracking.model.course import Course
from tracking.model.discrepancy import Discrepancy
from tracking.model.observation import ABSENT, MOUNTING, Observation, channels_alike
from tracking.smoother.smoothing_pass import Pass

#: Noise is known to a tenth (`tracking.model.noise`), so no more variance than this multiple of its own is noise.
NOISE_VARIANCE_TOLERANCE = 1.1**2
#: Over how long smoothing errors are added up [s]: several times what decimation correlates, several in a motion.
BLOCK_S = 0.25
#: Standard deviations beyond which something is hardly ever by chance: one in 16 000.
SIGMAS = 4.0


class MountedElsewhere(NamedTuple):
    """The largest departures of sensors from the arm's file: of a place [m] and of a rotation [rad]."""

    place_m: float
    turn_rad: float


@dataclass(frozen=True)
class Smoothed:
    """A motion, and how well it is known.

    Attributes
    ----------
    states : (n, n_state)
        Of every frame, in the order of `tracking.model.observation`.
    found : Pass
        Of the last pass.
    final, covariance : (n_state,), (n_state, n_state)
        After the last reading: what is known of the constants.
    before : (n_state, n_state)
        Covariance before the first reading.
    still, resting : (n,) bool
        Where the velocities were held to be zero, and where no motion goes on.
    doubted : float
        Share of the instants at which the readings contradict the arm.
    passes : int
    converged : bool
    course : Course
        The readings of the last pass, with the jolts, doubts and rests that were found.
    along : (n, n_state)
        Along which they were linearised in it.
    discrepancy : Discrepancy, optional
        What the model was found to lack of the readings, if that was sought.
    clocks : Clocks, optional
        By how much sensors were found to be late, if that was sought.
    is_near : bool
        Lengths and mountings are where they were held to be, within what they may be off.
    mounted_elsewhere : MountedElsewhere, optional
        Where only sensors that sit otherwise than the arm's file has them explain the readings: by how much.
    alike : tuple of slice
        The channels of each kind of sensor, see `tracking.model.observation.channels_alike`; by default all as
        one.
    """

    states: Floats
    found: Pass
    final: Floats
    covariance: Floats
    before: Floats
    still: NDArray[np.bool_]
    resting: NDArray[np.bool_]
    doubted: float
    passes: int
    converged: bool
    course: Course
    along: Floats
    discrepancy: Discrepancy | None = None
    is_near: bool = True
    clocks: Clocks | None = None
    mounted_elsewhere: MountedElsewhere | None = None
    alike: tuple[slice, ...] = (slice(None),)

    @property
    def summary(self) -> "Smoothed":
        """What was found of the motion, without the motion and its readings."""
        none, frames = np.zeros((0, 0)), np.zeros(0, dtype=np.bool_)
        course = self.course._replace(readings=none, present=frames, jolt=none, doubt=none, rest=none, drift=none)
        found = Pass(none, none, none, none)
        return replace(self, states=none, found=found, still=frames, resting=frames, course=course, along=none)

    def continued(self, x: Floats, P: Floats) -> None:
        """Put what is known at the end into state and covariance before a recording that follows it at once.

        Of a state with other constants than this one only motion and offsets go on.

        Parameters
        ----------
        x, P : (n_state,), (n_state, n_state)
            As if nothing had been known; changed in place.
        """
        same = slice(None) if len(x) == len(self.final) else slice(0, self._n_moving)
        x[same] = self.final[same]
        P[same, :], P[:, same] = 0.0, 0.0
        P[same, same] = self.covariance[same, same]

    @property
    def _n_moving(self) -> int:
        """Entries of motion and offsets, which any state begins with."""
        return 3 * self.course.push.size + self.course.noise.size

    @property
    def variance(self) -> Floats:
        """Of q, dq, ddq of every joint, (n, 3 n_joint)."""
        return self.found.variance[:, : 3 * self.course.push.size]

    @property
    def is_exact(self) -> bool:
        """Whether the readings are explained to the accuracy with which the sensors' noise is known.

        What the model lacks lasts, so that it shows in sums over a quarter of a second long before it does in a
        reading; and constants that are further from what was held of them than they may be explain nothing.
        """
        sums, expected = self._squared_sums(BLOCK_S)
        if not (self.converged and self.is_near):
            return False
        for part in self.alike:
            chance = SIGMAS * np.sqrt(2.0 / sums[:, part].size)  # of a mean of squares of normal numbers
            misfit = float(sums[:, part].sum() / expected[:, part].sum())
            if not misfit < NOISE_VARIANCE_TOLERANCE * (1.0 + chance):
                return False
        return True

    @property
    def residual(self) -> Floats:
        """What the motion leaves of the readings, (n, n_channel) [m/s^2]; nothing where there is none."""
        variance = self.course.noise * self.course.doubt
        left: Floats = variance * self.found.error[:, : self.course.noise.size]
        return left

    def _squared_sums(self, block_s: float) -> tuple[Floats, Floats]:
        """Return squared sums of smoothing errors over blocks, (n_block, n_channel), and what they are by chance.

        By chance they are no more than if the errors of a block were independent.
        """
        length = min(max(1, round(block_s / self.course.dt)), len(self.found.error))
        blocks = np.arange(0, len(self.found.error) - length + 1, length)
        channels = slice(0, self.course.noise.size)
        sums = np.add.reduceat(self.found.error[: blocks[-1] + length, channels], blocks, axis=0)
        expected = np.add.reduceat(self.found.precision[: blocks[-1] + length, channels], blocks, axis=0)
        return sums**2, expected


def contradicted(of: Observation, course: Course, found: Pass) -> bool:
    """Return whether a pass leaves more of the readings of any kind of sensor than their noise.

    A reading of variance R leaves R u, whose variance is less than R where the arm is right.
    """
    squares = course.noise * course.doubt * found.error[:, : course.noise.size] ** 2
    there = squares[course.present]
    return any(float(there[:, part].mean()) > NOISE_VARIANCE_TOLERANCE for part in channels_alike(of))


def is_near(of: Observation, moved: Floats, P0: Floats) -> bool:
    """Say whether lengths and mountings moved (n_state,) by no more than they may be off (n_state, n_state)."""
    mountings = [range(first, first + MOUNTING) for first in of.mounting_column.tolist() if first != ABSENT]
    lengths = of.length_column[of.length_column != ABSENT].tolist()
    scales = [range(first, first + 3) for first in of.gyro_scale_column.tolist() if first != ABSENT]
    columns = np.array([*lengths, *np.ravel(mountings), *np.ravel(scales)], dtype=np.intp)
    return bool(np.all(np.abs(moved[columns]) < SIGMAS * np.sqrt(P0[columns, columns])))


def mend(variance: Floats) -> None:
    """Fill in variances that lost all their digits, as at the end of a gap, from the instants around them."""
    at = np.arange(len(variance))
    for column in variance.T:
        there = ~np.isnan(column)
        if there.any():
            column[:] = np.interp(at, at[there], column[there])
