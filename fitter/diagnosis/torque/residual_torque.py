"""The residual torque over time, in the rows in which pulses are sought."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.least_squares import MAD_STD
from fitter.diagnosis.torque.background import Rows
from fitter.diagnosis.torque.neighbours import neighbours
from fitter.dynamics.robust import HUBER_SIGMAS


@dataclass(frozen=True)
class ResidualTorque:
    """What the torque equation misses in one trial, ``Y p - tau``: a push has its own sign.

    Both sides have passed the same low-pass filter, Y and tau alike. The parameters p have been fitted robustly:
    the pushes have not bent them.

    Attributes
    ----------
    t : (n,) [s]
        Uniform.
    r : (n, n_joint) [N m]
    known : (n, n_joint) of bool
        Whether the equation holds there, as it does not for a joint at rest of unknown friction.
    torque : (n, n_joint) [N m]
        The motors' torque tau, filtered alike.
    band_hz : float
        Corner of the filter.
    torque_noise : (n_joint,) [N m]
        Standard deviation of the noise in a sample of r that is white within the band.
    angle_noise : (n_joint,) [N m s^2]
        Standard deviation of the white noise in an unfiltered sample of the angle, times the joint's inertia.
    friction : (n, n_joint) [N m]
        Of joints, if they rest.
    turning : (n, n_joint)
        How far a sample is one at which a joint turns back, behind the filter, 0 to 1.
    at_rest : (n, n_joint) of bool
        Whether all but the friction that holds a joint is known, where the equation does not hold.
    """

    t: Floats
    r: Floats
    known: NDArray[np.bool_]
    torque: Floats
    band_hz: float
    torque_noise: Floats
    angle_noise: Floats
    friction: Floats
    turning: Floats
    at_rest: NDArray[np.bool_]

    def rows(self, joint: int) -> Rows:
        """Return one joint's residual at two rows a period of the band's corner: means of the samples between.

        Where the torque of the joint or of a neighbour changes its sign, a transmission with play strikes.

        The model errs in proportion to a torque (a gain) and its rate (a lag). It is what the motor's torque and
        the model's have in common where the residual is an outlier: a push is in the motor's if that resists it,
        in the model's if the arm gives way, and in no case a signal.
        """
        step_s = float(self.t[-1] - self.t[0]) / (len(self.t) - 1)
        m = max(1, round(0.5 / (self.band_hz * step_s)))
        n = len(self.t) // m

        def means(samples: Floats) -> Floats:
            return np.asarray(samples[: n * m].reshape(n, m, *samples.shape[1:]).mean(axis=1))

        def both(joint: int) -> tuple[Floats, Floats]:
            """Return the motor's torque at a joint and the model's where the residual is an outlier."""
            r = np.where(self.known[:, joint], self.r[:, joint], 0.0)
            return self.torque[:, joint], self.torque[:, joint] + _outlying(r, self.known[:, joint])

        own = both(joint)
        signals = np.stack([_common(*own), _common(*(np.gradient(one, step_s) for one in own))], axis=1)
        beside = [_common(*both(one)) for one in neighbours(joint, self.r.shape[1])]
        reversing = np.max([_reversing(torque, m) for torque in (signals[:, 0], *beside)], axis=0)
        known, seen = (
            np.asarray(one[: n * m, joint].reshape(n, m).all(axis=1))
            for one in (self.known, self.known | self.at_rest)
        )
        # Of m angles in a row one with the mean's noise: eq. (m.1) with its longer step.
        angle_noise = float(self.angle_noise[joint]) / np.sqrt(m)
        noises = (
            float(self.torque_noise[joint]),
            angle_noise,
            *(means(one[:, joint]) for one in (self.friction, self.turning)),
            means(reversing),
            seen & ~known,
        )
        return Rows(means(self.t), means(self.r[:, joint]), known, means(signals), m, self.band_hz, *noises)


def rows_by_joint(trials: Sequence[ResidualTorque]) -> list[list[Rows]]:
    """Return the rows of every joint, of every trial."""
    return [[trial.rows(joint) for trial in trials] for joint in range(trials[0].r.shape[1])]


def _outlying(r: Floats, known: NDArray[np.bool_]) -> Floats:
    """Return by how much a residual (n,) exceeds what is no outlier, 0 where it does not."""
    most = HUBER_SIGMAS * MAD_STD * float(np.median(np.abs(r[known]))) if known.any() else 0.0
    return np.asarray(r - np.clip(r, -most, most))


def _reversing(torque: Floats, reach: int) -> Floats:
    """Say where a torque (n,) changes its sign, however long it is none in between, as far as a filter looks."""
    acting = np.flatnonzero(torque)
    changed = np.flatnonzero(np.diff(np.sign(torque[acting])))
    where = np.zeros(len(torque) + 1)
    np.add.at(where, np.maximum(acting[changed] - reach, 0), 1.0)
    np.add.at(where, np.minimum(acting[changed + 1] + reach + 1, len(torque)), -1.0)
    return np.asarray(np.cumsum(where[:-1]) > 0.0, dtype=np.float64)


def _common(one: Floats, other: Floats) -> Floats:
    """Return what two signals have in common, (n,): the smaller one, 0 where they differ in sign."""
    return np.asarray(np.where(one * other > 0.0, np.where(np.abs(one) < np.abs(other), one, other), 0.0))
