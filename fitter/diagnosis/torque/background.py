"""What the torque equation misses without any push: a stationary coloured process in Student's noise.

In state space, with a step h between rows (mathematics.md, "The missing torque over time"):

    r_k = x_k + o_k + sum_i s_ik g_ik + (v_k+1 - 2 v_k + v_k-1) / h^2 + w_k                                   (m.1)

x is an Ornstein-Uhlenbeck process, o a damped oscillator driven by white noise, g_i are errors in proportion to
given signals s_i, v is the noise of the angles times the inertia and w is white. The standardised
innovations follow Student's distribution.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, minimize
from scipy.special import gammaln

from arm.model import Floats
from fitter.diagnosis.torque.kalman import Filter, gains

#: Least and greatest degrees of freedom: Cauchy's tails; at 30 Student's distribution passes for a normal one.
_DEGREES_OF_FREEDOM = (1.0, 30.0)
#: Damping ratios of the oscillator: ten periods of ringing; critical damping.
_DAMPING_RATIO = (0.03, 1.0)
#: Least standard deviation of any part of the background, as a ratio to that of the residual: rounding to zero.
_LEAST_RATIO = 1e-3
#: What lasts longer is no pulse but a bias or a load [s]. Errors in proportion to a signal do: they imitate none.
LONGEST_PULSE_S = 1.0
#: Time constant at which the likelihood's ascent starts [s]: part of a motion's period.
_TIME_CONSTANT_S = 0.3
#: … with every part of the background having this ratio of the residual's standard deviation.
_EQUAL_PARTS = 0.4
#: The ascent ends when the log likelihood of a row rises by less than this ratio.
_TOLERANCE = 1e-5


@dataclass(frozen=True)
class Rows:
    """The residual of one joint in one trial, at a uniform step.

    Attributes
    ----------
    t : (n,) [s]
    r : (n,) [N m]
    known : (n,) of bool
    signals : (n, n_signal)
        Signals in proportion to which the model may err.
    torque_noise, angle_noise : float [N m], [N m s^2]
        Standard deviation of a row's white torque noise; of the angle's noise times the inertia.
    """

    t: Floats
    r: Floats
    known: NDArray[np.bool_]
    signals: Floats
    torque_noise: float
    angle_noise: float

    @property
    def step_s(self) -> float:
        """Step between rows [s]."""
        return float(self.t[-1] - self.t[0]) / (len(self.t) - 1)


@dataclass(frozen=True)
class Background:
    """Parameters of eq. (m.1).

    Attributes
    ----------
    std, time_constant_s : float [N m], [s]
        Of the Ornstein-Uhlenbeck process.
    ringing, ringing_rad_s, damping_ratio : float [N m], [rad/s], [-]
        Standard deviation, angular frequency and damping of the oscillator.
    in_proportion : (n_signal,)
        Standard deviations of the errors in proportion to the signals.
    proportion_s : (n_signal,) [s]
        Their time constants.
    white : float [N m]
        White noise beyond the sensor's.
    degrees_of_freedom : float
        Of Student's distribution of the standardised innovations.
    """

    std: float
    time_constant_s: float
    ringing: float
    ringing_rad_s: float
    damping_ratio: float
    in_proportion: Floats
    proportion_s: Floats
    white: float
    degrees_of_freedom: float

    def filtered(self, rows: Rows) -> Filter:
        """Return the Kalman filter of a trial: its gains do not depend on the residual."""
        h, n_signal = rows.step_s, rows.signals.shape[1]
        d = 3 + n_signal
        F, P, Q = np.zeros((d + 3, d + 3)), np.zeros((d + 3, d + 3)), np.zeros((d + 3, d + 3))
        F[0, 0] = np.exp(-h / self.time_constant_s)
        F[1:3, 1:3] = self._ringing_transition(h)
        F[3:d, 3:d] = np.diag(np.exp(-h / self.proportion_s))
        ringing = [self.ringing**2, (self.ringing_rad_s * self.ringing) ** 2]
        P[:d, :d] = np.diag([self.std**2, *ringing, *self.in_proportion**2])
        Q[:d, :d] = P[:d, :d] - F[:d, :d] @ P[:d, :d] @ F[:d, :d].T  # stationary
        F[d + 1, d] = F[d + 2, d + 1] = 1.0  # the angle's noise of the next row, of this one, of the last one
        P[d:, d:] = np.eye(3) * rows.angle_noise**2
        Q[d, d] = rows.angle_noise**2
        C = np.zeros((len(rows.t), d + 3))
        C[:, 0] = C[:, 1] = 1.0
        C[:, 3:d] = rows.signals
        C[:, d:] = np.array([1.0, -2.0, 1.0]) / h**2
        variance = rows.torque_noise**2 + self.white**2
        gain, S = gains(F, Q, P, C, variance, rows.known)
        return Filter(F, Q, P, C, variance, gain, S, rows.known)

    def _ringing_transition(self, h: float) -> Floats:
        """Return the transition of the oscillator's value and rate over a step, (2, 2)."""
        w, decay = self.ringing_rad_s, self.damping_ratio * self.ringing_rad_s
        damped = w * np.sqrt(1.0 - self.damping_ratio**2)
        cosine, sine = np.cos(damped * h), h * np.sinc(damped * h / np.pi)
        turn = np.array([[cosine + decay * sine, sine], [-w * w * sine, cosine - decay * sine]])
        return np.asarray(np.exp(-decay * h) * turn)


def estimated(trials: Sequence[Rows], near: Background | None = None) -> Background:
    """Return the background of one joint, by maximum likelihood over its trials.

    Student's tails keep a few pushes from being taken for background. The ascent starts at the background `near`.
    """
    sizes = np.concatenate([rows.r[rows.known] for rows in trials])
    signals = np.concatenate([rows.signals[rows.known] for rows in trials])
    scale = float(_rms(sizes))
    # Of signals that are nothing, as the torque of an arm that swings freely, there are no errors in proportion.
    acts = np.any(signals, axis=0)
    unit = np.divide(scale, _rms(signals), out=np.zeros(len(acts)), where=acts)
    step_s, longest_s = trials[0].step_s, max(float(rows.t[-1] - rows.t[0]) for rows in trials)
    n_signal = len(unit)
    spread = (np.log(_LEAST_RATIO), np.log(10.0))
    lasting = (np.log(step_s), np.log(longest_s))
    slow = (max(lasting[0], min(np.log(LONGEST_PULSE_S), lasting[1])), lasting[1])
    ringing = (np.log(2.0 * np.pi / longest_s), np.log(np.pi / step_s))  # up to Nyquist's frequency
    bounds = [spread, lasting, spread, ringing, tuple(np.log(_DAMPING_RATIO)), spread]
    bounds += [tuple(np.log(_DEGREES_OF_FREEDOM)), *[spread] * n_signal, *[slow] * n_signal]

    def background(x: Floats) -> Background:
        z = np.exp(x)
        return Background(
            scale * z[0],
            z[1],
            scale * z[2],
            z[3],
            z[4],
            unit * z[7 : 7 + n_signal],
            z[7 + n_signal :],
            scale * z[5],
            z[6],
        )

    def loss(x: Floats) -> float:
        return -sum(log_likelihood(background(x), rows) for rows in trials) / max(len(sizes), 1)

    middle = float(np.exp(np.mean(ringing)))
    start = np.log(
        [
            *[_EQUAL_PARTS, _TIME_CONSTANT_S, _EQUAL_PARTS, middle, 0.5, _EQUAL_PARTS, 4.0],
            *[_EQUAL_PARTS] * n_signal,
            *[LONGEST_PULSE_S] * n_signal,
        ]
    )
    if near is not None:
        b = near
        widths = np.array([b.std, b.ringing, b.white]) / scale
        start = np.log(
            np.concatenate(
                [
                    [widths[0], b.time_constant_s, widths[1], b.ringing_rad_s, b.damping_ratio, widths[2]],
                    [b.degrees_of_freedom],
                    np.divide(b.in_proportion, unit, out=np.full(n_signal, _EQUAL_PARTS), where=acts),
                    b.proportion_s,
                ]
            )
        )
    low, high = np.transpose(bounds)
    start = np.clip(start, low, high)
    best = minimize(loss, start, method="L-BFGS-B", bounds=Bounds(low, high), options={"ftol": _TOLERANCE})
    return background(best.x)


def _rms(samples: Floats) -> Floats:
    """Return the rms of columns, never zero."""
    return np.asarray(np.sqrt(np.sum(samples**2, axis=0) / max(len(samples), 1)) + np.finfo(float).tiny)


def log_likelihood(background: Background, rows: Rows) -> float:
    """Return the log likelihood of a trial's known rows: Student's density of the innovations [nats]."""
    kalman = background.filtered(rows)
    e, S = kalman.innovations(rows.r)[rows.known], kalman.S[rows.known]
    nu = background.degrees_of_freedom
    constant = gammaln(0.5 * (nu + 1.0)) - gammaln(0.5 * nu) - 0.5 * np.log(nu * np.pi)
    return float(np.sum(constant - 0.5 * (nu + 1.0) * np.log1p(e * e / nu) - 0.5 * np.log(S)))
