"""A limb's angles over a whole trial: markers of every frame, and a motion prior across what is missing.

Angles are those of white jerk: third differences have a t distribution, ``S dt^5`` being the square of its scale.
So motion is smooth but for impacts: a blow, a grip or a wrist that is flicked changes a velocity within a frame or
two, and with a normal distribution the markers would be outliers there. With the markers' equations of every frame
that makes one banded system a Gauss-Newton step; its inverse, as far as the band reaches, has the variances.

After a few steps most frames stay where they are, and blows alone still move. What moves is then solved by itself,
the frames around it being held, until a step of all frames moves none.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from arm.marker_kinematics import MarkerChain, Slopes, slopes_room
from arm.model import Floats
from fitter.limb.marker_observations import AnglePrior, Frames
from fitter.limb.motion_equations import BEFORE, fill_band, inverse_diagonal, marker_equations, roughness
from protocol.markers.recording import runs

#: Spectral density of the jerk, of joints and turns of the base [rad²/s⁵], and of its shifts [m²/s⁵]: with
#: markers that wander by 8 mm some 15 cm from an axis the prior lets pass what is below about 12 Hz, more than
#: people's motion has but for impacts (Winter 2009: 6 Hz hold nearly all of it).
JERK_DENSITY, SWAY_JERK_DENSITY = 1e6, 4e4
#: Frequency up to which that is [Hz].
PASSES_HZ = 12.0
_MOST_ITERATIONS = 100
#: Iterations end where no angle changes by more: a tenth of a degree, where their errors are degrees [rad].
_CONVERGED_RAD = 2e-3
#: … and those of frames by themselves by more, so that the others seldom move them again [rad].
_SETTLED_RAD = 0.3 * _CONVERGED_RAD
_SHORTENED = (1.0, 0.5, 0.2, 0.05)
#: Frames that still move are solved by themselves where they, with those around them, are a smaller part of all.
_FEW = 0.5


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
    problem = _problem(chain, frames, std_m, prior, dt_s, q, jerk_share)
    n_frame, around = len(q), int(np.ceil(1.0 / (PASSES_HZ * dt_s)))
    now, converged = problem.cost(0, n_frame), False
    for _ in range(_MOST_ITERATIONS):
        step, after = problem.advance(0, n_frame, now)
        if after > now:  # no shorter step is better either: that is as far as it goes
            converged = bool(step.max() < 5.0 * _CONVERGED_RAD)
            break
        moving = step >= _CONVERGED_RAD
        if not moving.any():
            converged = True
            break
        now, near = after, np.convolve(moving, np.ones(2 * around + 1), "same") > 0.0
        if near.mean() < _FEW:
            for first, end in runs(near):
                now -= problem.settle(first, end)
    # skin's error is one and the same over the frames that the prior averages
    alike = max(1.0, 1.0 / (2.0 * PASSES_HZ * dt_s))
    variances = np.empty(q.size)
    inverse_diagonal(problem.factor(0, n_frame, 1.0 / alike).T, variances)
    return Smoothed(problem.q, np.sqrt(variances).reshape(q.shape), converged)


@dataclass
class _Problem:
    """A motion's equations, and how far its solution is.

    Attributes
    ----------
    A, a : (n_frame, n, n), (n_frame, n)
        The markers' equations at ``q``.
    pull : (n_frame, n)
        Half the slope of the jerk's prior there.
    """

    chain: MarkerChain
    frames: Frames
    variance: Floats
    prior: AnglePrior
    jerk: Floats
    room: Slopes
    q: Floats
    A: Floats
    a: Floats
    pull: Floats

    def cost(self, first: int, end: int) -> float:
        """Return minus twice the log posterior that some frames have to do with; write their equations."""
        markers = marker_equations(
            self.chain, self.frames, self.variance, self.prior, self.q, self.room, first, end, self.A, self.a
        )
        return markers + roughness(self.q, self.jerk, first, end, self.pull)

    def factor(self, first: int, end: int, share: float = 1.0) -> Floats:
        """Return the Cholesky factor of the information on some frames, a lower band."""
        n = self.q.shape[1]
        band = np.empty(((end - first) * n, BEFORE * n + 1))
        fill_band(self.q, self.jerk, self.A, share, first, end, band)
        return np.asarray(cholesky_banded(band.T, overwrite_ab=True, lower=True, check_finite=False))

    def advance(self, first: int, end: int, now: float) -> tuple[Floats, float]:
        """Go a step with some frames, if that costs no more than ``now``.

        Returns how far each frame goes, and what it costs then: more where no step is better and none was gone.
        """
        before, slope = self.q[first:end].copy(), (self.a[first:end] - self.pull[first:end]).ravel()
        step = cho_solve_banded((self.factor(first, end), True), slope, check_finite=False).reshape(before.shape)
        far = np.abs(step).max(axis=1)
        for share in _SHORTENED:
            self.q[first:end] = before + share * step
            cost = self.cost(first, end)
            if cost <= now:
                return share * far, cost
        self.q[first:end] = before
        self.cost(first, end)
        return far, np.inf

    def settle(self, first: int, end: int) -> float:
        """Go on with some frames until none of them moves; return what that gains."""
        begin = now = self.cost(first, end)
        for _ in range(_MOST_ITERATIONS):
            step, after = self.advance(first, end, now)
            if after > now:
                break
            now = after
            if step.max() < _SETTLED_RAD:
                break
        return begin - now


def _problem(
    chain: MarkerChain, frames: Frames, std_m: Floats, prior: AnglePrior, dt_s: float, q: Floats, jerk_share: float
) -> _Problem:
    n_frame, n = q.shape
    density = jerk_share * np.where(chain.revolute, JERK_DENSITY, SWAY_JERK_DENSITY)
    jerk = 1.0 / (density * dt_s**5)
    A, a, pull = np.empty((n_frame, n, n)), np.empty((n_frame, n)), np.empty((n_frame, n))
    return _Problem(chain, frames, std_m**2, prior, jerk, slopes_room(n, 0), q.copy(), A, a, pull)
