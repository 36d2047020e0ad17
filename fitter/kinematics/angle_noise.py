"""Noise of the joint angles: known, seen in their spectrum, or found together with the geometry."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.data.trial import Trial
from fitter.kinematics.incremental import IncrementalKinematics
from fitter.kinematics.moment_fit import MomentFit, MomentProblem
from fitter.kinematics.noise_floor import NEGLIGIBLE, noise_floor
from fitter.kinematics.tip_basis import GEOMETRY, turning
from limbcal.errors import ConfigError

Source = Literal["known", "spectrum", "moments"]

#: A variance is significant if it is this number of standard errors above zero.
_SIGNIFICANT = 2.0


@dataclass(frozen=True)
class AngleNoise:
    """Standard deviations of the angles' noise.

    Attributes
    ----------
    rad : (n_joint,) [rad, or m where a joint slides], or None
        None where it could not be estimated, and none was undone.
    source : str or None
        "known": given; "spectrum": the floor of the angles' spectra; "moments": estimated with the geometry.
    """

    rad: Floats | None
    source: Source | None

    @property
    def undone(self) -> Floats | None:
        """What there is to undo in sums of samples; None where there is nothing that could be seen."""
        return self.rad if self.rad is not None and np.any(self.rad >= NEGLIGIBLE) else None


def resolved_noise(
    arm: Arm, learn: Sequence[Trial], given: Literal["auto"] | None | Sequence[float]
) -> AngleNoise:
    """Return the noise as it is given, or as it shows in the spectra.

    Raises
    ------
    ConfigError
        If there is not one finite number a joint, none below zero.
    """
    if given is None:
        return AngleNoise(np.zeros(arm.n_joint), "known")
    if isinstance(given, str):
        floor = noise_floor(turning(arm), learn)
        return AngleNoise(floor, None if floor is None else "spectrum")
    rad = np.asarray(given, dtype=float)
    if rad.shape != (arm.n_joint,) or not (np.isfinite(rad).all() and np.all(rad >= 0.0)):
        raise ConfigError(f"angle noise is {list(given)}, expected {arm.n_joint} numbers that are not below 0")
    return AngleNoise(rad, "known")


def noise_from_moments(
    search: IncrementalKinematics, problem: MomentProblem, spread_m: float
) -> tuple[AngleNoise, NDArray[np.bool_]]:
    """Estimate the noise together with the geometry, from where the plain search ended.

    Parameters
    ----------
    search : IncrementalKinematics
    problem : MomentProblem
    spread_m : float
        How far the tip is from its mean, rms.

    Returns
    -------
    AngleNoise
        Zero for joints whose noise is so small that to estimate it costs more than to leave it: it is not
        significant, and even at its upper limit it would shrink lengths by less than their standard errors.
    estimated : (n_joint,) bool
        The other joints.
    """
    n = search.arm.n_joint
    estimated = np.ones(n, dtype=bool)
    if search.tip_rms_m < NEGLIGIBLE * spread_m:  # noise of any size would have left more than this
        return AngleNoise(np.zeros(n), "moments"), ~estimated
    share = 0.5 * search.tip_rms_m**2
    variance = np.full(n, share / (n * spread_m**2))
    while np.any(estimated):
        fit = problem.fit(search.best, search.sought, search.bounds, variance, estimated, np.sqrt(share / 3.0))
        limit = fit.variance + _SIGNIFICANT * fit.variance_std
        shrinks = 0.5 * limit > _least_std_m(search, fit) / spread_m
        significant = fit.variance > _SIGNIFICANT * fit.variance_std
        insignificant = np.flatnonzero(estimated & ~significant & ~shrinks)
        if not len(insignificant):
            return AngleNoise(np.sqrt(np.maximum(fit.variance, 0.0)), "moments"), estimated
        least = insignificant[np.argmin(limit[insignificant])]
        variance = np.maximum(fit.variance, 0.0)
        variance[least], estimated[least] = 0.0, False
    return AngleNoise(np.zeros(n), "moments"), estimated


def _least_std_m(search: IncrementalKinematics, fit: MomentFit) -> float:
    """Return the smallest standard error of a length; infinite where no length is determined."""
    lengths = search.sought % len(GEOMETRY) == GEOMETRY.index("a")
    return float(np.min(np.sqrt(np.diag(fit.covariance))[lengths], initial=np.inf))


def fit_from_moments(
    search: IncrementalKinematics, problem: MomentProblem, noise: AngleNoise, estimated: NDArray[np.bool_]
) -> MomentFit:
    """Return the geometry that fits the moments best, from where a search with the noise undone ended."""
    variance = np.zeros(search.arm.n_joint) if noise.rad is None else noise.rad**2
    return problem.fit(
        search.best, search.sought, search.bounds, variance, estimated, search.tip_rms_m / np.sqrt(3.0)
    )
