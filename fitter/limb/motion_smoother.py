"""A limb's angles over a whole trial: markers of every frame, and a motion prior across what is missing.

Angles are those of white jerk: third differences have a t distribution, ``S dt^5`` being the square of its scale.
So motion is smooth but for impacts: a blow, a grip or a wrist that is flicked changes a velocity within a frame or
two, and with a normal distribution the markers would be outliers there. With the markers' equations of every frame
that makes one banded system a Gauss-Newton step; its inverse, as far as the band reaches, has the variances
(Takahashi, Fagan and Chin 1973).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from arm.marker_kinematics import MarkerChain, Slopes, slopes_room
from arm.model import Floats
from fitter.limb.inverse_kinematics import frame_equations
from fitter.limb.marker_observations import FREEDOM, AnglePrior, Frames
from limbcal.compiled import compiled

#: Spectral density of the jerk, of joints and turns of the base [rad²/s⁵], and of its shifts [m²/s⁵]: with
#: markers that wander by 8 mm some 15 cm from an axis the prior lets pass what is below about 12 Hz, more than
#: people's motion has but for impacts (Winter 2009: 6 Hz hold nearly all of it).
JERK_DENSITY, SWAY_JERK_DENSITY = 1e6, 4e4
#: Frequency up to which that is [Hz].
PASSES_HZ = 12.0
_MOST_ITERATIONS = 100
#: Iterations end where no angle changes by more: a tenth of a degree, where their errors are degrees [rad].
_CONVERGED_RAD = 2e-3
_SHORTENED = (1.0, 0.5, 0.2, 0.05)


@dataclass(frozen=True)
class Smoothed:
    """Angles of a trial.

    Attributes
    ----------
    q, std : (n_frame, 6 + n_joint)
        The base's sway first; its standard deviation is of a frame by itself where markers are seen.
    converged : bool
    """

    q: Floats
    std: Floats
    converged: bool


def smooth(
    chain: MarkerChain,
    frames: Frames,
    std_m: Floats,
    prior: AnglePrior,
    dt_s: float,
    q: Floats,
    jerk_share: float = 1.0,
) -> Smoothed:
    """Return the most likely motion of one trial.

    Parameters
    ----------
    chain : MarkerChain
    frames : Frames
        Of one trial, one every step; markers may come and go.
    std_m : (m,)
    prior : AnglePrior
    dt_s : float
    q : (n_frame, 6 + n_joint)
        Where to begin.
    jerk_share : float
        Of the usual densities of the jerk.
    """
    n = q.shape[1]
    density = jerk_share * np.where(chain.revolute, JERK_DENSITY, SWAY_JERK_DENSITY)
    jerk = 1.0 / (density * dt_s**5)
    n_band = 3 * n + 1
    room = slopes_room(n, 0)
    A, a = np.empty((len(q), n, n)), np.empty((len(q), n))
    variance = std_m**2
    now = _equations(chain, frames, variance, prior, q, room, A, a) + _roughness(q, jerk)
    converged = False
    for _ in range(_MOST_ITERATIONS):
        factor = cholesky_banded(_jerk_band(q, jerk) + _data_band(A, n_band), lower=True)
        step = cho_solve_banded((factor, True), (a - _pull(q, jerk)).ravel()).reshape(q.shape)
        for share in _SHORTENED:
            trial = q + share * step
            found = _equations(chain, frames, variance, prior, trial, room, A, a) + _roughness(trial, jerk)
            if found <= now:
                break
        else:  # no shorter step is better either: that is as far as it goes
            _equations(chain, frames, variance, prior, q, room, A, a)
            converged = bool(np.abs(step).max() < 5.0 * _CONVERGED_RAD)
            break
        q, now = trial, found
        if np.abs(share * step).max() < _CONVERGED_RAD:
            converged = True
            break
    # skin's error is one and the same over the frames that the prior averages
    alike = max(1.0, 1.0 / (2.0 * PASSES_HZ * dt_s))
    factor = cholesky_banded(_jerk_band(q, jerk) + _data_band(A / alike, n_band), lower=True)
    variances = np.empty(q.size)
    _selected_inverse(np.ascontiguousarray(factor), variances)
    return Smoothed(q, np.sqrt(variances).reshape(q.shape), converged)


def _differences(n: int) -> Floats:
    """Return the coefficients of third differences; of fewer than four frames there are none."""
    return np.array([-1.0, 3.0, -3.0, 1.0]) if n >= 4 else np.zeros(4)


def _weights(rough: Floats, jerk: Floats) -> Floats:
    """Return the information of third differences, a t distribution's, (n_frame - 3, n)."""
    return np.asarray((FREEDOM + 1.0) / (FREEDOM + jerk * rough**2) * jerk)


def _jerk_band(q: Floats, jerk: Floats) -> Floats:
    """Return the prior's information about a motion as a lower band, (3 n + 1, n_frame n)."""
    n_frame, n = q.shape
    c, band = _differences(n_frame), np.zeros((3 * n + 1, n_frame, n))
    if n_frame >= 4:
        weight = _weights(np.diff(q, 3, axis=0), jerk)
        for i in range(4):
            for j in range(i, 4):
                band[(j - i) * n, i : n_frame - 3 + i] += c[i] * c[j] * weight
    return band.reshape(3 * n + 1, n_frame * n)


def _roughness(q: Floats, jerk: Floats) -> float:
    """Return minus twice the log prior of a motion, up to a constant."""
    if len(q) < 4:
        return 0.0
    return float((FREEDOM + 1.0) * np.sum(np.log1p(jerk * np.diff(q, 3, axis=0) ** 2 / FREEDOM)))


def _pull(q: Floats, jerk: Floats) -> Floats:
    """Return the slope of half the roughness."""
    out = np.zeros_like(q)
    if len(q) >= 4:
        rough = np.diff(q, 3, axis=0)
        rough *= _weights(rough, jerk)
        for i, c in enumerate(_differences(len(q))):
            out[i : len(q) - 3 + i] += c * rough
    return out


def _data_band(A: Floats, n_band: int) -> Floats:
    """Return frames' information (n_frame, n, n) as a lower band."""
    n_frame, n, _ = A.shape
    band = np.zeros((n_band, n_frame, n))
    for below in range(n):
        for i in range(n - below):
            band[below, :, i] = A[:, i + below, i]
    return band.reshape(n_band, n_frame * n)


@compiled
def _equations(
    chain: MarkerChain,
    frames: Frames,
    variance: Floats,
    prior: AnglePrior,
    q: Floats,
    room: Slopes,
    A: Floats,
    a: Floats,
) -> float:
    total = 0.0
    for k in range(q.shape[0]):
        total += frame_equations(chain, frames, k, variance, prior, q[k], room, A[k], a[k])
    return total


@compiled
def _selected_inverse(L: Floats, variances: Floats) -> None:
    """Fill in the diagonal of the inverse, given the Cholesky factor as a lower band."""
    width, n = L.shape[0] - 1, L.shape[1]
    Z = np.zeros((n, width + 1))  # Z[j, k]: element (j + k, j) of the inverse
    for j in range(n - 1, -1, -1):
        most = min(width, n - 1 - j)
        d = L[0, j]
        for k in range(most, -1, -1):
            total = 1.0 / d if k == 0 else 0.0
            for m in range(1, most + 1):
                low, high = (m, k) if m < k else (k, m)
                total -= L[m, j] * Z[j + low, high - low]
            Z[j, k] = total / d
        variances[j] = Z[j, 0]
