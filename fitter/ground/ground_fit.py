"""The most likely bodies under a prior, and how far they may be from it: eq. (4)'s base rows by Gauss-Newton.

Unknown are the bodies' numbers x (`fitter.ground.deformation`), the coefficients b of what is not rigid or not
calibrated (`fitter.ground.disturbances`), and the power of the rest in every band of every row. Given the power, x and
b have one normal equation; given these, the power is what they leave, their own uncertainty included: the EM
algorithm (Dempster, Laird and Rubin 1977).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.ground.deformation import Deformation
from fitter.ground.frequency_rows import N_ROW, FrequencyRows
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
        Of x, whatever the disturbances are.
    disturbance : (n_disturbance,)
    power : (n_band, 6, 6)
        Covariance of what is left of a coefficient's six rows, by band.
    rounds : int
    """

    x: Floats
    covariance: Floats
    disturbance: Floats
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
        Prior standard deviations of their coefficients, about zero.

    Raises
    ------
    NotConverged
        If the search does not end.
    """
    n = deformation.size
    band = rows.bands()
    n_band = int(band.max()) + 1
    root = np.linalg.cholesky(prior.covariance + 1e-12 * np.diag(np.diag(prior.covariance)))
    Y, D = rows.Y[..., :n], rows.Y[..., n:] * disturbance_std
    z, b = np.zeros(n), np.zeros(len(disturbance_std))  # in prior standard deviations
    floor = np.diag(_LEAST_POWER * np.mean(rows.w**2, axis=0) + np.finfo(np.float64).tiny)

    def left(z: Floats, b: Floats) -> Floats:
        return np.asarray(rows.w - Y @ deformation.parameters(prior.mean + root @ z) - D @ b)

    def by_band(products: Floats) -> Floats:
        total = np.zeros((n_band, N_ROW, N_ROW))
        np.add.at(total, band, products)
        return np.asarray(total / np.bincount(band)[:, None, None] + floor)

    power = by_band(_outer(left(z, b)))
    for number in range(1, _MOST_ROUNDS + 1):
        A = np.concatenate([Y @ (deformation.slopes(prior.mean + root @ z) @ root), D], axis=2)
        weight = np.linalg.inv(np.linalg.cholesky(power))[band]
        H, g = _normal(A, weight, left(z, b))
        H += np.eye(len(H))
        step = np.linalg.solve(H, g - np.concatenate([z, b]))
        now = _cost(left(z, b), weight, z, b)
        for share in _SHORTENED:
            z1, b1 = z + share * step[:n], b + share * step[n:]
            if _cost(left(z1, b1), weight, z1, b1) <= now:
                break
        moved = float(np.abs(share * step).max())
        z, b = z1, b1
        covariance = np.linalg.inv(H)
        spread = (A @ covariance) @ A.transpose(0, 2, 1)
        before, power = power, by_band(_outer(left(z, b)) + spread)
        changed = np.log(np.einsum("brr->br", power) / np.einsum("brr->br", before))
        if moved < _CONVERGED and np.abs(changed).max() < 5.0 * _CONVERGED:
            break
    if moved > _LARGEST_STEP:
        raise NotConverged(
            f"masses still change by {moved:.1f} prior standard deviations after {_MOST_ROUNDS} rounds: the equations may "
            "be of another person"
        )
    return Posterior(
        prior.mean + root @ z, root @ covariance[:n, :n] @ root.T, b * disturbance_std, power, number
    )


def _normal(A: Floats, weight: Floats, residual: Floats) -> tuple[Floats, Floats]:
    rows = (weight @ A).reshape(-1, A.shape[2])
    return rows.T @ rows, rows.T @ (weight @ residual[..., None]).ravel()


def _cost(residual: Floats, weight: Floats, z: Floats, b: Floats) -> float:
    return float(np.sum((weight @ residual[..., None]) ** 2) + z @ z + b @ b)


def _outer(residual: Floats) -> Floats:
    return residual[:, :, None] * residual[:, None, :]


Mask = NDArray[np.bool_]
