"""Geometry and angle noise together, by the generalised method of moments (Hansen 1982).

There are more moments than unknowns. Weighted with the inverse of their covariance they have about as much
information as least squares would that knew every sample's noise, because products of the tip itself are among
them: a tip that is known well determines the angles nearly as well as the angles do.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.model import Floats
from fitter.data.trial import Trial
from fitter.kinematics.angle_products import basis_factor
from fitter.kinematics.tip_basis import basis, coefficients
from fitter.kinematics.tip_moments import HIGHEST, MomentSums, TipMoments, joined
from fitter.search.standard_errors import sandwich_covariance

#: Samples that the moments' covariance is taken from, and how many there must be for each moment: with fewer
#: the inverse of their covariance is chance, and what it weights is weighted wrongly.
_SAMPLES = 20_000
_SAMPLES_PER_MOMENT = 60
_MOST_MOMENTS = 600
#: Products of more joints than this, of which each has 9 harmonics, become too many.
MOST_JOINTS = 4
#: Number of reweightings, each at the answer of the one before.
_ROUNDS = 3
#: Combinations of moments with less than this fraction of the largest variance are rounding.
_RANK = 1e-10
_BLOCKS = 256
#: Tip noise is not the same in all directions where the score test for it exceeds the quantile 0.999 of chi-square
#: with 5 degrees of freedom by what a variance does that is off by a tenth: less does not matter.
_NOT_ISOTROPIC = 20.5
_MATTERS = 0.1
_ROUND = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class MomentFit:
    """An answer of the method of moments.

    Attributes
    ----------
    geometry : (n_joint, 5)
    covariance : (n_sought, n_sought)
        Of the numbers sought of it.
    variance, variance_std : (n_joint,) [rad^2 or m^2]
        Of the angles' noise; the standard error is 0 where the variance was given.
    tip_noise_m : float
        Root of the mean variance of the tip's coordinates.
    """

    geometry: Floats
    covariance: Floats
    variance: Floats
    variance_std: Floats
    tip_noise_m: float


class MomentProblem:
    """Trials reduced to moments, to be fitted under several assumptions.

    Parameters
    ----------
    revolute : (n_joint,) bool
    trials : sequence of Trial
        With a tip.

    Raises
    ------
    ValueError
        If the samples are not enough, see `enough`.
    """

    def __init__(self, revolute: tuple[bool, ...], trials: Sequence[Trial]) -> None:
        samples = sum(len(trial.q) for trial in trials)
        if not enough(revolute, samples):
            raise ValueError(f"{samples} samples of {len(revolute)} joints, expected more samples or fewer joints")
        self._revolute = revolute
        self._moments = _most(revolute, samples)
        # Where the base stands may differ from trial to trial, so each counts from its mean at first.
        tips = [np.asarray(trial.tip) - np.mean(np.asarray(trial.tip), axis=0) for trial in trials]
        blocks = max(1, _BLOCKS // len(trials))
        self._sums = joined([self._moments.sums(trial.q, tips[k], k, blocks) for k, trial in enumerate(trials)])
        self._mean_basis = np.array([_mean_basis(revolute, trial.q) for trial in trials])
        every = max(1, samples // _SAMPLES)
        self._q = np.concatenate([trial.q for trial in trials])[::every]
        self._tip = np.concatenate(tips)[::every]
        self._trial = np.repeat(np.arange(len(trials)), [len(tip) for tip in tips])[::every]

    def fit(
        self,
        start: Floats,
        which: NDArray[np.intp],
        bounds: tuple[Floats, Floats],
        variance: Floats,
        estimated: NDArray[np.bool_],
        tip_noise: float,
    ) -> MomentFit:
        """Fit the geometry, and the angle noise of some joints.

        Parameters
        ----------
        start : (n_joint, 5)
        which : (n_sought,) int
            Places in the flattened geometry that are sought.
        bounds : lower, upper, (n_sought,) each
        variance : (n_joint,)
            Of the angles' noise: known, or where to start.
        estimated : (n_joint,) bool
            Whose noise is not known. Where any is estimated, the tip's noise is taken to be the same in all
            directions, unless the moments contradict.
        tip_noise : float [m]
            Where to start.

        Returns
        -------
        MomentFit
        """
        R = tip_noise**2 * _ROUND
        if not np.any(estimated):
            return self._fit(start, which, bounds, variance, estimated, R, isotropic=False)[0]
        alike, contradiction = self._fit(start, which, bounds, variance, estimated, R, isotropic=True)
        if contradiction < _NOT_ISOTROPIC + 0.5 * _MATTERS**2 * self._sums.count.sum():
            return alike
        R = alike.tip_noise_m**2 * _ROUND
        return self._fit(alike.geometry, which, bounds, alike.variance, estimated, R, isotropic=False)[0]

    def _fit(
        self,
        geometry: Floats,
        which: NDArray[np.intp],
        bounds: tuple[Floats, Floats],
        variance: Floats,
        estimated: NDArray[np.bool_],
        R: Floats,
        *,
        isotropic: bool,
    ) -> tuple[MomentFit, float]:
        n_sought, n_noise = len(which), int(np.count_nonzero(estimated))
        noise = slice(n_sought + 3, n_sought + 3 + n_noise)  # after the geometry and where the base stands
        beyond = np.full(3 + n_noise + (1 if isotropic else 6), np.inf)
        lower, upper = np.append(bounds[0], -beyond), np.append(bounds[1], beyond)
        held, known = geometry.copy(), variance.copy()

        def unpacked(x: Floats) -> tuple[Floats, Floats, Floats]:
            held.flat[which], known[estimated] = x[:n_sought], x[noise]
            C = coefficients(self._revolute, held[None])[0]
            C[:, 0] += x[n_sought : noise.start]
            return C, known, x[noise.stop :] * (_ROUND if isotropic else 1.0)

        x = np.concatenate([geometry.ravel()[which], np.zeros(3), variance[estimated], R[:1] if isotropic else R])
        for _ in range(_ROUNDS):
            x[n_sought : noise.start] = 0.0
            C, v, R = unpacked(x)
            origin = (self._mean_basis * basis_factor(self._revolute, v)) @ C.T
            sums = self._moments.moved(self._sums, origin)
            whole = sums.whole()
            weight = _inverse_root(self._moments.samples(self._q, self._tip + origin[self._trial], C, v, R))

            def residual(x: Floats, weight: Floats = weight, whole: MomentSums = whole) -> Floats:
                return np.asarray(weight @ self._moments.values(whole, *unpacked(x))[0], dtype=np.float64)

            inside = np.clip(x, lower, upper)
            found = scipy.optimize.least_squares(residual, inside, bounds=(lower, upper), x_scale="jac")
            x = found.x
        by_block = self._moments.values(sums, *unpacked(x)) @ weight.T
        covariance = _covariance(np.asarray(found.jac), by_block, sums)
        std = np.zeros(len(variance))
        std[estimated] = np.sqrt(np.diag(covariance)[noise])
        tip_noise = float(np.sqrt(max(unpacked(x)[2][:3].mean(), 0.0)))
        fit = MomentFit(held.copy(), covariance[:n_sought, :n_sought], known.copy(), std, tip_noise)
        # By how much the moments would lie closer to zero if the tip's noise had any covariance (a score test).
        one_each = np.array(
            [self._moments.values(whole, C, known, other)[0] for other in (np.zeros(6), *np.eye(6))]
        )
        tilted = np.column_stack([np.asarray(found.jac), weight @ (one_each[1:] - one_each[0]).T])
        axes, size, _ = np.linalg.svd(tilted / np.linalg.norm(tilted, axis=0), full_matrices=False)
        closer = axes[:, size > _RANK * size[0]].T @ found.fun
        return fit, float(closer @ closer * sums.count.sum())


def enough(revolute: tuple[bool, ...], samples: int) -> bool:
    """Return whether the number of samples is enough for the method."""
    return len(revolute) <= MOST_JOINTS and TipMoments(revolute, 1).size * _SAMPLES_PER_MOMENT <= samples


def _most(revolute: tuple[bool, ...], samples: int) -> TipMoments:
    """Return as many moments as the samples can weigh against one another."""
    most = min(_MOST_MOMENTS, samples // _SAMPLES_PER_MOMENT)
    choice = [TipMoments(revolute, order) for order in range(1, HIGHEST * len(revolute) + 1)]
    return max(
        (moments for moments in choice if moments.size <= most),
        key=lambda moments: moments.size,
        default=choice[0],
    )


def _mean_basis(revolute: tuple[bool, ...], q: Floats) -> Floats:
    chunks = (basis(revolute, q[start : start + 8192]).sum(axis=0) for start in range(0, len(q), 8192))
    return np.asarray(sum(chunks) / len(q), dtype=np.float64)


def _inverse_root(samples: Floats) -> Floats:
    """Return V with ``V^T V`` the inverse of the moments' covariance, as far as that has one."""
    centred = samples - samples.mean(axis=0)
    scale = np.sqrt(np.mean(centred**2, axis=0))
    seen = np.flatnonzero(scale > 1e-12 * scale.max())
    unit = centred[:, seen] / scale[seen]
    power, axes = np.linalg.eigh(unit.T @ unit / len(unit))
    is_determined = power > _RANK * power[-1]
    V = np.zeros((np.count_nonzero(is_determined), samples.shape[1]))
    V[:, seen] = (axes[:, is_determined] / np.sqrt(power[is_determined])).T / scale[seen]
    return V


def _covariance(slopes: Floats, by_block: Floats, sums: MomentSums) -> Floats:
    """Return the answer's covariance from the scatter of the blocks' scores."""
    scores = -(by_block @ slopes) * sums.count[:, None]
    normal = slopes.T @ slopes
    W = np.asarray(np.linalg.qr(slopes * np.sqrt(sums.count.sum())).R)
    grams = sums.count[:, None, None] * normal
    return sandwich_covariance(W, grams, scores, sums.trial)
