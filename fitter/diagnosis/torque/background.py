"""What the torque equation misses without any push: a stationary coloured process in Student's noise.

In state space, with a step h between rows (mathematics.md, "The missing torque over time"):

    r_k = x_k + o_k + sum_i s_ik g_ik + (v_k+1 - 2 v_k + v_k-1) / h^2 + w_k                                   (m.1)

x is an Ornstein-Uhlenbeck process, o a damped oscillator driven by white noise, g_i are errors in proportion to
given signals s_i, v is the noise of the angles times the inertia and w is white: the sensors', the model's, that
of friction where the joint turns back, and that of contacts where its torque changes its sign. The standardised
innovations follow Student's distribution.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from arm.model import Floats
from fitter.diagnosis.torque.kalman import Filter, gains
from fitter.diagnosis.torque.kalman_adjoint import log_density
from limbcal.compiled import compiled

#: What lasts longer is no pulse but a bias or a load [s]. Errors in proportion to a signal do: they imitate none.
LONGEST_PULSE_S = 1.0
#: Numbers of a background that no signal adds…
_N_SINGLE = 9
#: … and places of some of them.
DEGREES_OF_FREEDOM, CONTACT = 7, 8
#: States that are the angle's noise, the last ones.
_N_ANGLE = 3


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
    n_sample : int
        Samples whose mean a row is…
    band_hz : float
        … behind a low-pass filter with this corner.
    torque_noise, angle_noise : float [N m], [N m s^2]
        Standard deviation of a row's white torque noise; of the angle's noise times the inertia.
    friction : (n,) [N m]
        Of the joint, if it rests.
    turning : (n,)
        For which part of a row it turns back, 0 to 1.
    reversing : (n,)
        For which part of a row its torque changes its sign, 0 to 1.
    at_rest : (n,) of bool
        Whether nothing but the friction that holds the joint is unknown.
    """

    t: Floats
    r: Floats
    known: NDArray[np.bool_]
    signals: Floats
    n_sample: int
    band_hz: float
    torque_noise: float
    angle_noise: float
    friction: Floats
    turning: Floats
    reversing: Floats
    at_rest: NDArray[np.bool_]

    @property
    def friction_error(self) -> Floats:
        """Standard deviation of friction, (n,) [N m]: uniform between either way's where a joint turns back."""
        return np.asarray(self.friction * self.turning / np.sqrt(3.0))

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
    white, angle : float [N m], [N m s^2]
        White noise, and noise of the angles times the inertia, beyond the sensors'.
    degrees_of_freedom : float
        Of Student's distribution of the standardised innovations.
    contact : float [N m]
        Standard deviation of what is missed where the torque changes its sign: a transmission with play strikes.
    """

    std: float
    time_constant_s: float
    ringing: float
    ringing_rad_s: float
    damping_ratio: float
    in_proportion: Floats
    proportion_s: Floats
    white: float
    angle: float
    degrees_of_freedom: float
    contact: float

    @property
    def numbers(self) -> Floats:
        """All of them, those that signals add last, (9 + 2 n_signal,)."""
        single = [self.std, self.time_constant_s, self.ringing, self.ringing_rad_s, self.damping_ratio]
        single += [self.white, self.angle, self.degrees_of_freedom, self.contact]
        return np.concatenate([single, self.in_proportion, self.proportion_s])

    @classmethod
    def of(cls, numbers: Floats) -> "Background":
        """Return the background of such numbers."""
        n_signal = (len(numbers) - _N_SINGLE) // 2
        single = map(float, numbers[:_N_SINGLE])
        std, time_constant_s, ringing, ringing_rad_s, damping_ratio, white, angle, nu, contact = single
        in_proportion, proportion_s = numbers[_N_SINGLE : _N_SINGLE + n_signal], numbers[_N_SINGLE + n_signal :]
        ringings = ringing, ringing_rad_s, damping_ratio
        return cls(std, time_constant_s, *ringings, in_proportion, proportion_s, white, angle, nu, contact)

    def filtered(self, rows: Rows) -> Filter:
        """Return the filter of a trial whose rows have no outliers: its gains do not depend on the residual."""
        noises = rows.step_s, rows.torque_noise, rows.angle_noise
        F, Q, P, white = state_space(self.numbers, *noises)
        C, variance = outputs(rows.signals, rows.step_s), white + self.uneven_variance(rows)
        own = gains(F, Q, P, C, variance, rows.known, n_torque(F), np.zeros((0, *F.shape)))
        return Filter(F, Q, P, C, variance, *own, rows.known)

    def uneven_variance(self, rows: Rows) -> Floats:
        """Return the variance of the white noise that only some rows have, (n,) [N^2 m^2]."""
        return np.asarray(rows.friction_error**2 + (self.contact * rows.reversing) ** 2)

    def mean_log_density(self, rows: Rows, block_s: float) -> Floats:
        """Return the mean log density of a row, in each row's block of some length, (n,); NaN if none is known."""
        kalman, nu = self.filtered(rows), self.degrees_of_freedom
        e = kalman.weighted(rows.r, nu).innovations(rows.r)
        density = -0.5 * (nu + 1.0) * np.log1p(e**2 / nu) - 0.5 * np.log(kalman.S)
        block = np.arange(len(e)) // max(1, round(block_s / rows.step_s))
        known = np.bincount(block, rows.known)
        with np.errstate(invalid="ignore"):
            means = np.bincount(block, np.where(rows.known, density, 0.0)) / known
        return np.asarray(means[block])


@compiled
def state_space(
    numbers: Floats, h: float, torque_noise: float, angle_noise: float
) -> tuple[Floats, Floats, Floats, float]:
    """Return F, Q, P and the white noise's variance of eq. (m.1) with a step h."""
    n_signal = (len(numbers) - _N_SINGLE) // 2
    d = 3 + n_signal
    F, Q, P = np.zeros((d + 3, d + 3)), np.zeros((d + 3, d + 3)), np.zeros((d + 3, d + 3))
    F[0, 0], P[0, 0] = np.exp(-h / numbers[1]), numbers[0] ** 2
    ringing, w = numbers[2], numbers[3]
    decay, damped = numbers[4] * w, w * np.sqrt(1.0 - numbers[4] ** 2)
    sine = np.sin(damped * h) / damped if damped * h > 0.0 else h
    F[1, 1], F[1, 2] = np.cos(damped * h) + decay * sine, sine
    F[2, 1], F[2, 2] = -w * w * sine, np.cos(damped * h) - decay * sine
    F[1:3, 1:3] *= np.exp(-decay * h)
    P[1, 1], P[2, 2] = ringing**2, (w * ringing) ** 2
    for i in range(n_signal):
        F[3 + i, 3 + i] = np.exp(-h / numbers[_N_SINGLE + n_signal + i])
        P[3 + i, 3 + i] = numbers[_N_SINGLE + i] ** 2
    Q[:] = P - F @ P @ np.ascontiguousarray(F.T)  # stationary
    F[d + 1, d] = F[d + 2, d + 1] = 1.0  # the angle's noise of the next row, of this one, of the last one
    for i in range(3):
        P[d + i, d + i] = angle_noise**2 + numbers[6] ** 2
    Q[d, d] = P[d, d]
    return F, Q, P, torque_noise**2 + numbers[5] ** 2


@compiled
def outputs(signals: Floats, h: float) -> Floats:
    """Return what each state of eq. (m.1) adds to a row, (n, d)."""
    n, n_signal = signals.shape
    d = 3 + n_signal
    C = np.zeros((n, d + 3))
    C[:, 0] = C[:, 1] = 1.0
    C[:, 3:d] = signals
    C[:, d], C[:, d + 1], C[:, d + 2] = 1.0 / h**2, -2.0 / h**2, 1.0 / h**2
    return C


@compiled
def n_torque(F: Floats) -> int:
    """Return how many states are torques, or in proportion to one: all but the angle's noise."""
    return len(F) - _N_ANGLE


def rms(trials: Sequence[Rows]) -> float:
    """Return the rms of the trials' known rows [N m], 1 if all are zero or none is known."""
    known = np.concatenate([rows.r[rows.known] for rows in trials])
    return float(np.sqrt(np.sum(known**2) / max(len(known), 1))) or 1.0


def log_likelihood(background: Background, trials: Sequence[Rows]) -> float:
    """Return the log likelihood of the trials' known rows: Student's density of the innovations [nats]."""
    nu = background.degrees_of_freedom
    total = constant(nu) * sum(int(np.count_nonzero(rows.known)) for rows in trials)
    for rows in trials:
        kalman = background.filtered(rows)
        e = kalman.weighted_innovations(rows.r, nu)
        total += log_density(rows.r, e, kalman.S, rows.known, nu)
    return float(total)


def constant(nu: float) -> float:
    """Return the constant of the logarithm of Student's density."""
    return float(gammaln(0.5 * (nu + 1.0)) - gammaln(0.5 * nu) - 0.5 * np.log(nu * np.pi))
