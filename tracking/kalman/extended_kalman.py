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
            Covariance of their noise, which is independent: a diagonal.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the innovation has no covariance that can be inverted.
        """
        self.x, self.P, squared = correct(self.x, self.P, z, H, predicted, at, R)
        return float(squared)


@compiled
def predict(F: Floats, Q: Floats, x: Floats, P: Floats) -> tuple[Floats, Floats]:
    """Return state and covariance a frame later. Most of ``F`` is zero, and is passed over."""
    size = x.size
    ahead, half, later = np.zeros(size), np.zeros((size, size)), Q.copy()
    for a in range(size):
        for c in range(size):
            share = F[a, c]
            if share != 0.0:
                ahead[a] += share * x[c]
                for b in range(size):
                    half[b, a] += share * P[c, b]
    for a in range(size):
        for c in range(size):
            share = F[a, c]
            if share != 0.0:
                for b in range(size):
                    later[a, b] += share * half[c, b]
    symmetrise(later)
    return ahead, later


@compiled
def symmetrise(P: Floats) -> None:
    """Take out what rounding has made of a covariance that is symmetric."""
    for a in range(P.shape[0]):
        for b in range(a):
            P[a, b] = P[b, a] = 0.5 * (P[a, b] + P[b, a])


@compiled
def correct(
    x: Floats, P: Floats, z: Floats, H: Floats, predicted: Floats, at: Floats, R: Floats
) -> tuple[Floats, Floats, float]:
    """Take in readings one after the other, whose noise is independent: the diagonal of ``R`` is all that counts.

    What comes of it is what comes of all at once, to rounding, without a matrix to be inverted. The innovation's
    squared size is the sum of theirs, each by its own variance after those before it.
    """
    size, squared = x.size, 0.0
    x, P, gain = x.copy(), P.copy(), np.empty(size)
    for i in range(z.size):
        miss, total = z[i] - predicted[i], R[i, i]
        gain[:] = 0.0
        for c in range(size):
            slope = H[i, c]
            if slope != 0.0:
                miss -= slope * (x[c] - at[c])
                for a in range(size):
                    gain[a] += slope * P[c, a]
        for c in range(size):
            total += H[i, c] * gain[c]
        if not total > 0.0:
            raise np.linalg.LinAlgError("A reading without noise tells nothing.")
        for a in range(size):
            share = gain[a] / total
            x[a] += share * miss
            for b in range(size):
                P[a, b] -= share * gain[b]
        squared += miss * miss / total
    symmetrise(P)
    return x, P, squared
