"""The background of one joint by maximum likelihood over its trials."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.special import digamma

from arm.model import Floats
from fitter.diagnosis.torque.background import (
    CONTACT,
    DEGREES_OF_FREEDOM,
    LONGEST_PULSE_S,
    Background,
    Rows,
    constant,
    n_torque,
    outputs,
    state_space,
)
from fitter.diagnosis.torque.kalman_adjoint import log_density_slopes
from limbcal.compiled import compiled

#: Step of differences, as a ratio to a number: about the cube root of rounding.
_STEP = 1e-5
#: Ratio of the frequencies of ringing from which ascents start: two octaves.
_START_RATIO = 4.0
#: Variance of a start's ringing, as a ratio to that of any other part (by trial, see decisions/022).
_START_RINGING = 0.1


def estimated(
    trials: Sequence[Rows],
    near: Background | None = None,
    *,
    freedom: tuple[float, float] = (1.0, 30.0),
    damping: tuple[float, float] = (0.03, 1.0),
    least: float = 1e-3,
    tolerance: float = 1e-4,
) -> Background:
    """Return the background of one joint, by maximum likelihood over its trials.

    Student's tails keep a few pushes from being taken for background. The ascent starts at the background `near`.

    Parameters
    ----------
    trials : sequence of Rows
    near : Background, optional
    freedom : (float, float)
        Degrees of freedom, from Cauchy's tails; at 30 Student's distribution passes for a normal one.
    damping : (float, float)
        Damping ratios of the oscillator: ten periods of ringing; critical damping.
    least : float
        Standard deviation of any part of the background, as a ratio to that of the residual: rounding to zero.
    tolerance : float
        The ascent ends when the log likelihood of a row rises by less than this ratio.
    """
    sizes = np.concatenate([rows.r[rows.known] for rows in trials])
    signals = np.concatenate([rows.signals[rows.known] for rows in trials])
    scale = float(_rms(sizes))
    # Of signals that are nothing, as the torque of an arm that swings freely, there are no errors in proportion.
    acts = np.any(signals, axis=0)
    unit = np.divide(scale, _rms(signals), out=np.zeros(len(acts)), where=acts)
    step_s, longest_s = trials[0].step_s, max(float(rows.t[-1] - rows.t[0]) for rows in trials)
    n_signal = len(unit)
    spread = (np.log(least), np.log(10.0))
    lasting = (np.log(step_s), np.log(longest_s))
    slow = (max(lasting[0], min(np.log(LONGEST_PULSE_S), lasting[1])), lasting[1])
    ringing = (np.log(2.0 * np.pi / longest_s), np.log(np.pi / step_s))  # up to Nyquist's frequency
    bounds = [spread, lasting, spread, ringing, tuple(np.log(damping)), spread, spread]
    bounds += [tuple(np.log(freedom)), spread, *[spread] * n_signal, *[slow] * n_signal]
    low, high = np.transpose(bounds)
    angle = scale * step_s**2 / np.sqrt(6.0)  # whose second difference is of the residual's size
    units = np.concatenate([[scale, 1.0, scale, 1.0, 1.0, scale, angle, 1.0, scale], unit, np.ones(n_signal)])

    def at(x: Floats) -> Background:
        return Background.of(units * np.exp(x))

    def loss(x: Floats) -> tuple[float, Floats]:
        value, slopes = log_likelihood_slopes(at(x), trials)
        return -value / max(len(sizes), 1), -slopes * at(x).numbers / max(len(sizes), 1)

    def begun(ringing_rad_s: float) -> Floats:
        part = 1.0 / np.sqrt(5.0 + n_signal)  # all parts of equal variance…
        little = np.sqrt(_START_RINGING) * part  # …but ringing: a large one takes over what another part does
        start = [part, LONGEST_PULSE_S, little, ringing_rad_s, 0.5, part, part, 4.0, part]
        start += [*[part] * n_signal, *[LONGEST_PULSE_S] * n_signal]
        if near is not None:
            start = list(np.divide(near.numbers, units, out=np.array(start), where=units > 0.0))
        return np.asarray(np.clip(np.log(start), low, high))

    box = scipy.optimize.Bounds(low, high)
    options: dict[str, Any] = {"method": "L-BFGS-B", "jac": True, "options": {"ftol": tolerance}}
    # The likelihood has a maximum for every frequency that rings, and its value where an ascent starts does not
    # tell how high that one leads. So one starts in every second octave: so wide is the resonance of a start.
    n = int(np.ceil((ringing[1] - ringing[0]) / np.log(_START_RATIO)))
    starts = np.exp(np.linspace(*ringing, n + 1)) if near is None else [near.ringing_rad_s]
    ascents = [scipy.optimize.minimize(loss, begun(start), bounds=box, **options) for start in starts]
    return at(min(ascents, key=lambda ascent: float(ascent.fun)).x)


def log_likelihood_slopes(background: Background, trials: Sequence[Rows]) -> tuple[float, Floats]:
    """Return `log_likelihood` of a background, and its slopes with the background's numbers, (9 + 2 n_signal,)."""
    numbers, nu = background.numbers, background.degrees_of_freedom
    n_known = sum(int(np.count_nonzero(rows.known)) for rows in trials)
    total, slopes = constant(nu) * n_known, np.zeros(len(numbers))
    slopes[DEGREES_OF_FREEDOM] = 0.5 * n_known * (digamma(0.5 * (nu + 1.0)) - digamma(0.5 * nu) - 1.0 / nu)
    for rows in trials:
        noises = rows.step_s, rows.torque_noise, rows.angle_noise
        uneven = background.uneven_variance(rows)
        part, own, variance_bar = _of_trial(numbers, rows.signals, rows.r, rows.known, *noises, uneven)
        total, slopes = total + part, slopes + own
        slopes[CONTACT] += 2.0 * background.contact * float(variance_bar @ rows.reversing**2)
    return float(total), slopes


@compiled
def _of_trial(
    numbers: Floats,
    signals: Floats,
    r: Floats,
    known: NDArray[np.bool_],
    h: float,
    torque_noise: float,
    angle_noise: float,
    uneven_variance: Floats,
) -> tuple[float, Floats, Floats]:
    """Return a trial's log density, its slopes with a background's numbers, and with each row's variance."""
    F, Q, P, white = state_space(numbers, h, torque_noise, angle_noise)
    variance = white + uneven_variance
    C, nu = outputs(signals, h), numbers[DEGREES_OF_FREEDOM]
    own = log_density_slopes(F, Q, P, C, variance, known, n_torque(F), r, nu)
    density, F_bar, Q_bar, P_bar, variance_bar, nu_bar = own
    slopes, white_bar = np.zeros(len(numbers)), np.sum(variance_bar)
    for i in range(len(numbers)):
        step = _STEP * numbers[i]
        if step == 0.0:  # an error in proportion to nothing
            continue
        # From below: no damping is more than critical. 3 f(x) - 4 f(x - h) + f(x - 2 h) is 2 h f'(x) + O(h^3).
        for times, weight in ((0.0, 3.0), (1.0, -4.0), (2.0, 1.0)):
            near = numbers.copy()
            near[i] -= times * step
            F, Q, P, white = state_space(near, h, torque_noise, angle_noise)
            part = np.sum(F_bar * F) + np.sum(Q_bar * Q) + np.sum(P_bar * P) + white_bar * white
            slopes[i] += weight * part / (2.0 * step)
    slopes[DEGREES_OF_FREEDOM] = nu_bar
    return density, slopes, variance_bar


def _rms(samples: Floats) -> Floats:
    """Return the rms of columns, never zero."""
    return np.asarray(np.sqrt(np.sum(samples**2, axis=0) / max(len(samples), 1)) + np.finfo(float).tiny)
