"""When a motor surely touches a side of its gap, and how its link moves there."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_erosion, gaussian_filter1d

from arm.model import Floats
from fitter.diagnosis.free_link import FreeLink
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, ROUNDED, SIGMAS

#: The torque's sign is determined behind Gaussians of these widths [s]; within one a contact is not certain. The
#: narrowest places a large torque, the others see a small and steady one.
WIDTHS_S = (0.004, 0.008, 0.016, 0.032, 0.064)
#: A motor whose torque does not differ significantly from zero for this long may be anywhere in its gap [s].
WANDERS_S = 0.02
#: A link's velocity where a contact ends is that of so long a time at most [s]; from 0.06 s on the residual of a
#: simulated arm hardly depends on it.
BESIDE_S = 0.2
#: Samples that a motor takes to cross when nothing holds it.
CROSSING = 2
#: Samples of a contact that are taken to say how its link moves, if it is shorter.
FEW = 5


class Run(NamedTuple):
    """Samples from a first to a last at which a motor touches a side, -1 or 1."""

    first: int
    last: int
    side: float


class Knot(NamedTuple):
    """What is known of a link at a sample.

    Angle of its motor and its own velocity [rad], [rad a sample], their covariance (2, 2) in units of the variance
    of an angle's noise, and the side at which its motor is.
    """

    at: int
    angle: float
    slope: float
    covariance: Floats
    side: float


def contact_side(torque: Floats, noise: float, dt_s: float) -> Floats:
    """Return the side that a motor touches, (n_sample,), 0 where it is not sure.

    A large torque counts no more than one that is just seen in a sample: it would reach beyond its end.
    """
    clipped = np.clip(torque, -SIGMAS * noise, SIGMAS * noise)
    side = np.zeros(len(torque))
    for width in (max(width_s / dt_s, 0.5) for width_s in WIDTHS_S):
        smooth = gaussian_filter1d(clipped, width)
        least = SIGMAS * noise / np.sqrt(2.0 * np.sqrt(np.pi) * width)
        around = np.ones(2 * round(EQUAL_SIGMAS * width) + 1, dtype=np.bool_)
        for way in (1.0, -1.0):
            side[binary_erosion(way * smooth > least, around, border_value=True)] = way
    return side


def contact_runs(torque: Floats, noise: float, dt_s: float) -> list[Run]:
    """Return the stretches of time in which a motor surely touches one side.

    Parameters
    ----------
    torque : (n_sample,)
        Of the motor.
    noise : float
        Its standard deviation in a sample.
    dt_s : float
    """
    touching = contact_side(torque, noise, dt_s)
    sure = np.flatnonzero(touching)
    if not len(sure):
        return []
    sign = touching[sure]
    leaves = np.flatnonzero((np.diff(sure) > max(3, round(WANDERS_S / dt_s))) | (np.diff(sign) != 0.0))
    firsts, lasts = np.concatenate([[0], leaves + 1]), np.concatenate([leaves, [len(sure) - 1]])
    return [Run(int(sure[a]), int(sure[b]), float(sign[a])) for a, b in zip(firsts, lasts, strict=True)]


@dataclass(frozen=True)
class Motor:
    """What is measured of a joint with a gap, and what moves its link.

    Attributes
    ----------
    angle, torque : (n_sample,)
        Of the motor.
    noise : (float, float)
        Standard deviations of both in a sample.
    starts : sequence of int
        Samples at which some drive was suddenly asked for another torque: what rested, rested till then.
    link : FreeLink
    dt_s : float
    """

    angle: Floats
    torque: Floats
    noise: tuple[float, float]
    starts: Sequence[int]
    link: FreeLink
    dt_s: float

    def departure(self, run: Run) -> Knot:
        """Return how a link moves when its motor leaves it."""
        first = max(min(run.first, run.last - FEW), run.last - self._beside, 0)
        return Knot(run.last, *self._end(slice(first, run.last + 1), -1), run.side)

    def arrival(self, run: Run) -> Knot:
        """Return how a link moves when its motor has arrived."""
        last = min(max(run.last, run.first + FEW), run.first + self._beside, len(self.angle) - 1)
        return Knot(run.first, *self._end(slice(run.first, last + 1), 0), run.side)

    def runs(self) -> list[Run]:
        """Return when it surely touches a side."""
        return contact_runs(self.torque, self.noise[1], self.dt_s)

    def coasted(self, left: Knot, samples: slice) -> tuple[Floats, Floats]:
        """Return angles and slopes of a link from a knot on [rad], [rad a sample], while its motor is in its gap.

        What torque is left at the ends of a contact that is not certain moves it; one that is seen in a sample
        would be a contact, unless it moved the motor alone.
        """
        least = SIGMAS * self.noise[1]
        return self._moved(samples, np.clip(self.torque[samples], -least, least), left.angle, left.slope)

    @property
    def unsure(self) -> int:
        """By how many samples a contact with a large torque lasts longer than it is sure."""
        return round(EQUAL_SIGMAS * WIDTHS_S[0] / self.dt_s)

    def wander(self, samples: slice) -> float:
        """Return the density of the acceleration that the model lacks, white, as variances of an angle.

        Twice integrated over n samples between known angles and slopes it has the variance n^3 s^3 (1 - s)^3 / 3
        at the share s of them, from known ones on n^3 / 3 (integrated Brownian motion).
        """
        lacking = self.link.lacking_acceleration(samples) * self.dt_s**2 / self.noise[0]
        return min(lacking**2 * self._beside, 1.0 / ROUNDED**2)

    @property
    def _beside(self) -> int:
        return max(FEW, round(BESIDE_S / self.dt_s))

    def _moved(self, samples: slice, torque: Floats, angle: float, slope: float) -> tuple[Floats, Floats]:
        angles, speeds = self.link.moved(samples, torque, angle, slope / self.dt_s, self.dt_s)
        return angles, speeds * self.dt_s

    def _end(self, samples: slice, at: int) -> tuple[float, float, Floats]:
        """Return angle and slope at the first or the last of some angles, and their covariance.

        The window is halved until its residual is no more than noise, by its sum of squares (chi-square).
        """
        while True:
            angle, slope, covariance, squares = self._fitted(samples, at)
            n = samples.stop - samples.start
            if n <= FEW or squares <= n + SIGMAS * np.sqrt(2.0 * n):
                return angle, slope, covariance
            n = max(FEW, n // 2)
            samples = slice(samples.stop - n, samples.stop) if at else slice(samples.start, samples.start + n)

    def _fitted(self, samples: slice, at: int) -> tuple[float, float, Floats, float]:
        """Return angle and slope at one of some angles, their covariance, and the residual sum of squares of all.

        The link moves with its motor: by the torque, and by a constant acceleration that the model lacks, which is
        known beforehand by its size (Bayesian linear regression).
        """
        seen, noise = self.angle[samples], self.noise[0]
        t = np.arange(len(seen), dtype=np.float64)
        powers = np.vander(t - t[at], 3, increasing=True)
        began = np.linalg.lstsq(powers, seen, rcond=None)[0]
        slope = float(began[1] + 2.0 * began[2] * (t[0] - t[at]))
        moved, slopes = self._moved(samples, self.torque[samples], float(seen[0]), slope)
        lacking = self.link.lacking_acceleration(samples) * 0.5 * self.dt_s**2
        prior = np.array([0.0, 0.0, (noise / max(lacking, ROUNDED * noise)) ** 2])
        information = powers.T @ powers + np.diag(prior)
        scale = np.sqrt(np.maximum(np.diag(information), 1.0))
        covariance = np.linalg.pinv(information / np.outer(scale, scale), hermitian=True) / np.outer(scale, scale)
        fitted = covariance @ powers.T @ (seen - moved)
        squares = float(np.sum((seen - moved - powers @ fitted) ** 2)) / noise**2
        return float(moved[at] + fitted[0]), float(slopes[at] + fitted[1]), covariance[:2, :2], squares
