"""What the plates' zero and place are off by: what the learnt bodies leave and no body can make.

With the bodies' parameters at their most likely values eq. (4)'s base rows leave r = P d + e: P of
`fitter.ground.disturbances.plate_columns`, d ~ N(0, S) the plates' errors, and e the power that the fit found in
each band with what skin adds. The posterior mean of d is K r with K = (P' W P + S^-1)^-1 P' W; its covariance has
what is not known of the bodies beside that of e.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.ground.disturbances import plate_columns
from fitter.ground.frequency_rows import FrequencyRows, mean_by_band
from fitter.ground.ground_fit import Posterior

#: Their coefficients: three of the place, three of the zero.
N_PLATE = 6


@dataclass(frozen=True)
class PlateCalibration:
    """Errors of all plates together.

    Attributes
    ----------
    value, std : (6,)
        Where they stand beyond where they were said to be [m], and what they read without a load [N], both in
        frame 0.
    """

    value: Floats
    std: Floats

    def wrench(self, measured: Floats) -> Floats:
        """Return what of a measured wrench about the base link's origin is the plates' error, (n_sample, 6)."""
        return np.asarray(plate_columns(measured) @ self.value)

    def document(self) -> dict[str, dict[str, list[float]]]:
        """Return what stands in a JSON document under ``plates``."""
        place, zero = slice(0, 3), slice(3, N_PLATE)
        return {
            name: {"value": self.value[part].tolist(), "std": self.std[part].tolist()}
            for name, part in (("place_m", place), ("zero_N", zero))
        }


def plate_calibration(
    rows: FrequencyRows, std: Floats, posterior: Posterior, theta: Floats, covariance: Floats
) -> PlateCalibration:
    """Estimate the plates' errors beside learnt bodies.

    Parameters
    ----------
    rows : FrequencyRows
        Columns: the bodies' standard parameters, those of skin, then the plates' six.
    std : (n_disturbance,)
        Prior standard deviations of skin's and the plates' coefficients.
    posterior : Posterior
    theta, covariance : (10 n_body,), (10 n_body, 10 n_body)
        Learnt standard parameters.
    """
    n = len(theta)
    Y, skin, plates = np.split(rows.Y, [n, rows.Y.shape[2] - N_PLATE], axis=2)
    band = rows.bands()
    variance = posterior.power + mean_by_band(band, np.sum((skin * std[:-N_PLATE]) ** 2, axis=2))
    weight = (variance[band] ** -0.5)[..., None]
    P, A = ((weight * x).reshape(-1, x.shape[2]) for x in (plates, Y))
    r = (weight[..., 0] * (rows.w - Y @ theta)).ravel()
    own = np.linalg.inv(P.T @ P + np.diag(std[-N_PLATE:] ** -2.0))
    carried = own @ P.T @ A
    total = own + carried @ covariance @ carried.T
    return PlateCalibration(own @ P.T @ r, np.sqrt(np.diag(total)))
