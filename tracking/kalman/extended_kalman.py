"""filterpy's extended Kalman filter with its two steps compiled: a thousand frames a second need them fast."""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from arm.model import Floats
from limbcal.compiled import compiled


class CompiledKalmanFilter(ExtendedKalmanFilter):  # type: ignore[misc] # filterpy has no types
    """An extended Kalman filter whose steps give what filterpy's own give, to rounding.

    Of what those leave behind only the state ``x`` and its covariance ``P`` are kept.
    """

    P: Floats
    x: Floats

    def predict(self, u: Floats | None = None) -> None:
        """Carry state and covariance on by ``F`` and ``Q``; ``u`` (dim_x,) is added to the state."""
        self.x, self.P = predict(self.F, self.Q, self.x, self.P)
        if u is not None:
            self.x += u

    def correct(self, z: Floats, H: Floats, predicted: Floats, at: Floats, R: Floats) -> float:
        """Take in readings that are linearised in some state; return the innovation's squared size.

        Parameters
        ----------
        z : (n,)
            The readings, of any number.
        H : (n, dim_x)
            Their slopes in the state ``at``.
        predicted : (n,)
            What they would be in the state ``at``.
        at : (dim_x,)
        R : (n, n)
            Covariance of their noise.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the innovation has no covariance that can be inverted.
        """
        self.x, self.P, squared = correct(self.x, self.P, z, H, predicted, at, R)
        return float(squared)


@compiled
def predict(F: Floats, Q: Floats, x: Floats, P: Floats) -> tuple[Floats, Floats]:
    """Return state and covariance a frame later."""
    return F @ x, F @ P @ F.T + Q


@compiled
def correct(
    x: Floats, P: Floats, z: Floats, H: Floats, predicted: Floats, at: Floats, R: Floats
) -> tuple[Floats, Floats, np.float64]:
    """Do the steps in filterpy's order, with its form of the covariance (Joseph's), which stays positive."""
    PHT = P @ H.T
    inverse = np.linalg.inv(H @ PHT + R)
    gain = PHT @ inverse
    miss = z - predicted - H @ (x - at)
    I_KH = np.eye(x.size) - gain @ H
    return x + gain @ miss, I_KH @ P @ I_KH.T + gain @ R @ gain.T, np.dot(miss, inverse @ miss)
