"""The most likely bodies under a prior, and how far they may be from it: eq. (4)'s base rows by Gauss-Newton.

Unknown are the bodies' numbers x (`fitter.ground.deformation`) and the power of what they leave in every band of
every row. Given the power, x has a normal equation; given x, the power is what it leaves, its own uncertainty
included: the EM algorithm (Dempster, Laird and Rubin 1977). What is neither rigid nor calibrated
(`fitter.ground.disturbances`) is no unknown, since a posture that comes back would be explained by it instead of
by bodies: its mean power in a band lowers the weight of a row, and its covariance, carried through the estimate,
is part of the answer's.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.ground.deformation import Deformation
from fitter.ground.frequency_rows import N_ROW, FrequencyRows, mean_by_band
from fitter.ground.mass_prior import MassPrior
from limbcal.errors import NotConverged

_MOST_ROUNDS = 30
#: Rounds end where no number moves by more, in prior standard deviations.
_CONVERGED = 0.02
#: There is no answer if some still move by more.
_LARGEST_STEP = 0.5
#: Parts of a step that are tried in turn.
_SHORTENED = (1.0, 0.5, 0.25, 0.1)
#: No power is smaller, as a share of the row's whole: rounding.
_LEAST_POWER = 1e-12


@dataclass(frozen=True)
class Posterior:
    """What is known of the bodies once the ground was measured.

    Attributes
    ----------
    x : (10 n_body,)
        Numbers of the deformation.
    covariance : (10 n_body, 10 n_body)
        Of x, disturbances included.
    power : (n_band, 6)
        Variance of a coefficient's residual, by band and row.
    rounds : int
    """

    x: Floats
    covariance: Floats
    power: Floats
    rounds: int


def ground_fit(
    rows: FrequencyRows, deformation: Deformation, prior: MassPrior, disturbance_std: Floats
) -> Posterior:
    """Fit bodies.

    Parameters
    ----------
    rows : FrequencyRows
        Columns: 10 standard parameters a body, then the disturbances.
    deformation : Deformation
    prior : MassPrior
    disturbance_std : (n_disturbance,)
        Standard deviations of their coefficients, about zero.

    Raises
    ------
    NotConverged
        If the search does not end.
    """
    n = deformation.size
    band = rows.bands()
    root = np.linalg.cholesky(prior.covariance + 1e-12 * np.diag(np.diag(prior.covariance)))
    Y, D = rows.Y[..., :n], rows.Y[..., n:] * disturbance_std
    z = np.zeros(n)  # in prior standard deviations
    floor = _LEAST_POWER * np.mean(rows.w**2, axis=0) + np.finfo(np.float64).tiny

    def left(z: Floats) -> Floats:
        return np.asarray(rows.w - Y @ deformation.parameters(prior.mean + root @ z))

    def by_band(squares: Floats) -> Floats:
        return np.asarray(mean_by_band(band, squares) + floor)

    carried = by_band(np.sum(D**2, axis=2))
    power = by_band(left(z) ** 2)
    rounds = 0
    while rounds < _MOST_ROUNDS:
        rounds += 1
        A = Y @ (deformation.slopes(prior.mean + root @ z) @ root)
        weight = (power + carried)[band] ** -0.5
        H, g = _normal(A, weight, left(z))
        H += np.eye(n)
        step = np.linalg.solve(H, g - z)
        now = _cost(left(z), weight, z)
        for share in _SHORTENED:
            tried = z + share * step
            if _cost(left(tried), weight, tried) <= now:
                break
        moved = float(np.abs(share * step).max())
        z = tried
        covariance = np.linalg.inv(H)
        flat = A.reshape(-1, n)
        spread = np.einsum("ij,ij->i", flat @ covariance, flat).reshape(-1, N_ROW)
        before, power = power, by_band(left(z) ** 2 + spread)
        if moved < _CONVERGED and np.abs(np.log(power / before)).max() < 5.0 * _CONVERGED:
            break
    if moved > _LARGEST_STEP:
        raise NotConverged(
            f"masses still change by {moved:.1f} prior standard deviations after {_MOST_ROUNDS} rounds: the "
            f"equations may be of another person"
        )
    gain = covariance @ (weight[..., None] ** 2 * A).reshape(-1, n).T
    shrunk = np.eye(n) - gain @ A.reshape(-1, n)
    noise, skin = gain * np.sqrt(power[band].ravel()), gain @ D.reshape(len(gain.T), -1)
    covariance = shrunk @ shrunk.T + noise @ noise.T + skin @ skin.T
    return Posterior(prior.mean + root @ z, root @ covariance @ root.T, power, rounds)


def _normal(A: Floats, weight: Floats, residual: Floats) -> tuple[Floats, Floats]:
    rows = (weight[..., None] * A).reshape(-1, A.shape[2])
    return rows.T @ rows, rows.T @ (weight * residual).ravel()


def _cost(residual: Floats, weight: Floats, z: Floats) -> float:
    return float(np.sum((weight * residual) ** 2) + z @ z)
