"""Shapes of a trial with a few free numbers: a Fourier series that begins and ends at rest, or points in a row."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.linalg

from arm.model import Floats

#: Harmonics of a series (Swevers et al. 1997; Park 2006 for its rests).
HARMONICS = 5
#: Mean time for which a point is held [s]; fraction of it that is a move where the reference is the motion itself.
POINT_S, MOVE = 1.25, 0.8


class Shape(Protocol):
    """What turns genes into a trial. Genes lie between -1 and 1."""

    @property
    def n_gene(self) -> int:
        """How many free numbers there are."""
        ...

    def trial(self, genes: Floats, t: Floats, before: Floats) -> Floats:
        """Return angle, velocity and acceleration of the reference.

        Parameters
        ----------
        genes : (n_gene,)
        t : (n_sample,) [s]
        before : (n_joint,)
            Where the trial before ended.

        Returns
        -------
        (3, n_sample, n_joint)
        """
        ...


@dataclass(frozen=True)
class Fourier:
    """A finite Fourier series for each joint, which begins and ends at zero without velocity or acceleration.

    Attributes
    ----------
    seconds, rest_s : float
        Of a trial, and of its rests at both ends.
    span : (n_joint,)
        No joint's reference leaves this to either side: larger ones are scaled down as a whole.
    """

    seconds: float
    rest_s: float
    span: Floats

    @property
    def n_gene(self) -> int:
        """How many free numbers there are: three a joint go into beginning at rest."""
        return (2 * HARMONICS - 2) * len(self.span)

    def trial(self, genes: Floats, t: Floats, before: Floats) -> Floats:
        """Return angle, velocity and acceleration; see `Shape`."""
        del before  # every trial begins and ends at zero
        active = self.seconds - 2.0 * self.rest_s
        phase = np.clip((t - self.rest_s) / active, 0.0, 1.0)
        moving = (phase > 0.0) & (phase < 1.0)
        w = 2.0 * np.pi * np.arange(1, HARMONICS + 1)
        rates = np.asarray(w / active, dtype=np.float64)
        free = scipy.linalg.null_space(_at_rest(rates))
        coefficients = free @ genes.reshape(len(self.span), -1).T  # (2 HARMONICS + 1, n_joint)
        cos, sin = np.cos(np.outer(phase, w)), np.sin(np.outer(phase, w))
        one, zero = np.ones((len(t), 1)), np.zeros((len(t), 1))
        motion = np.array(
            [
                np.hstack([one, cos, sin]) @ coefficients,
                np.hstack([zero, -rates * sin, rates * cos]) @ coefficients,
                np.hstack([zero, -(rates**2) * cos, -(rates**2) * sin]) @ coefficients,
            ]
        )
        motion *= moving[:, None]
        top = np.max(np.abs(motion[0]), axis=0)
        return np.asarray(motion * self.span / np.maximum(top, 1.0), dtype=np.float64)


@dataclass(frozen=True)
class Points:
    """One point after the other, each held for a while; the last one to the end.

    Attributes
    ----------
    seconds, rest_s : float
        Of a trial, and of its rest at the beginning.
    span : (n_joint,)
        Points lie within this to either side.
    smooth : bool
        Go from point to point with the least jerk (Flash and Hogan 1985); otherwise the reference jumps.
    """

    seconds: float
    rest_s: float
    span: Floats
    smooth: bool

    @property
    def points(self) -> int:
        """How many points a trial has."""
        return max(1, int((self.seconds - self.rest_s) / POINT_S))

    @property
    def n_gene(self) -> int:
        """How many free numbers there are: one a point and joint."""
        return self.points * len(self.span)

    def trial(self, genes: Floats, t: Floats, before: Floats) -> Floats:
        """Return angle, velocity and acceleration; see `Shape`."""
        goals = np.vstack([before, genes.reshape(self.points, -1) * self.span])
        each = (self.seconds - self.rest_s) / self.points
        since = (t - self.rest_s) / each + 1e-9
        k = np.clip(np.floor(since).astype(np.intp), -1, self.points - 1)
        motion = np.zeros((3, len(t), len(self.span)))
        if not self.smooth:
            motion[0] = goals[k + 1]
            return motion
        move_s = MOVE * each
        start, step = goals[np.maximum(k, 0)], np.diff(goals, axis=0)[np.maximum(k, 0)]
        s = np.clip((since - k) / MOVE, 0.0, 1.0)[:, None] * (k >= 0)[:, None]
        motion[0] = start + step * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        motion[1] = step * 30.0 * s**2 * (1.0 - s) ** 2 / move_s
        motion[2] = step * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / move_s**2
        return motion


def _at_rest(rates: Floats) -> Floats:
    """Return the rows that say zero, without velocity or acceleration, at the beginning; the end is the same."""
    none, one = np.zeros(len(rates)), np.ones(len(rates))
    return np.array([[1.0, *one, *none], [0.0, *none, *rates], [0.0, *rates**2, *none]])
