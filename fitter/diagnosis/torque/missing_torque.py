"""The torque that moves the arm and stands in no equation, over time: smoothed, with its band."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm
from scipy.stats import t as student

from arm.model import Floats
from fitter.diagnosis.torque.background import Background, Rows
from fitter.diagnosis.torque.kalman import Filter


@dataclass(frozen=True)
class ResidualTorque:
    """What the torque equation misses in one trial, ``Y p - tau``: a push has its own sign.

    Both sides have passed the same low-pass filter, Y and tau alike. The parameters p have been fitted robustly:
    the pushes have not bent them.

    Attributes
    ----------
    t : (n,) [s]
        Uniform.
    r : (n, n_joint) [N m]
    known : (n, n_joint) of bool
        Whether the equation holds there, as it does not for a joint at rest of unknown friction.
    torque : (n, n_joint) [N m]
        The motors' torque tau, filtered alike. The model errs in proportion to it (a gain) and its rate (a lag).
    band_hz : float
        Corner of the filter.
    torque_noise : (n_joint,) [N m]
        Standard deviation of the noise in a sample of r that is white within the band.
    angle_noise : (n_joint,) [N m s^2]
        Standard deviation of the white noise in an unfiltered sample of the angle, times the joint's inertia.
    """

    t: Floats
    r: Floats
    known: NDArray[np.bool_]
    torque: Floats
    band_hz: float
    torque_noise: Floats
    angle_noise: Floats

    def rows(self, joint: int) -> Rows:
        """Return one joint's residual at two rows a period of the band's corner: means of the samples between."""
        step_s = float(self.t[-1] - self.t[0]) / (len(self.t) - 1)
        m = max(1, round(0.5 / (self.band_hz * step_s)))
        n = len(self.t) // m

        def means(samples: Floats) -> Floats:
            return np.asarray(samples[: n * m].reshape(n, m, *samples.shape[1:]).mean(axis=1))

        torque = self.torque[:, joint]
        signals = np.stack([torque, np.gradient(torque, step_s)], axis=1)
        known = np.asarray(self.known[: n * m, joint].reshape(n, m).all(axis=1))
        r = np.where(self.known[:, joint], self.r[:, joint], 0.0)
        # Of m angles in a row one with the mean's noise: eq. (m.1) with its longer step.
        angle_noise = float(self.angle_noise[joint]) / np.sqrt(m)
        noises = float(self.torque_noise[joint]), angle_noise
        return Rows(means(self.t), means(r), known, means(signals), m, self.band_hz, *noises)


@dataclass(frozen=True)
class MissingTorque:
    """The missing torque of one trial and the half width of its 68 % band.

    Attributes
    ----------
    t : (n_row,) [s]
    torque, band : (n_row, n_joint) [N m]
    """

    t: Floats
    torque: Floats
    band: Floats


def missing_torques(trials: Sequence[ResidualTorque], models: Sequence[Background]) -> list[MissingTorque]:
    """Return the missing torque of each trial: what the equation misses, without the sensors' noise.

    Parameters
    ----------
    trials : sequence of ResidualTorque
    models : sequence of Background
        One a joint.

    Returns
    -------
    list of MissingTorque
    """
    smoothed, within = [], norm.cdf(1.0)  # the band has the probability of one standard deviation
    for trial in trials:
        joints = [(trial.rows(joint), model) for joint, model in enumerate(models)]
        parts = [_smoothed(rows, model.filtered(rows)) for rows, model in joints]
        # The scale of Student's distribution becomes the half width of its band.
        widths = [float(student.ppf(within, model.degrees_of_freedom)) for model in models]
        band = np.stack([np.sqrt(part[1]) * width for part, width in zip(parts, widths, strict=True)], axis=1)
        smoothed.append(MissingTorque(joints[0][0].t, np.stack([part[0] for part in parts], axis=1), band))
    return smoothed


def _smoothed(rows: Rows, kalman: Filter) -> tuple[Floats, Floats]:
    """Return mean and variance (n,) of the model's error: Rauch, Tung and Striebel's smoother (1965)."""
    n, d = kalman.C.shape
    part = np.arange(d) < d - 3  # the last three states are the angle's noise
    x, P = np.zeros((n, d)), np.zeros((n, d, d))
    x_next, P_next = np.zeros(d), kalman.P
    predicted = []
    for k in range(n):
        predicted.append((x_next, P_next))
        x[k] = x_next + kalman.gain[k] * (rows.r[k] - kalman.C[k] @ x_next)
        P[k] = P_next - np.outer(kalman.gain[k], kalman.C[k] @ P_next)
        x_next, P_next = kalman.F @ x[k], kalman.F @ P[k] @ kalman.F.T + kalman.Q
    for k in range(n - 2, -1, -1):
        x_next, P_next = predicted[k + 1]
        G = np.linalg.lstsq(P_next, kalman.F @ P[k], rcond=None)[0].T
        x[k] += G @ (x[k + 1] - x_next)
        P[k] += G @ (P[k + 1] - P_next) @ G.T
    C = kalman.C * part
    variance = np.einsum("ki,kij,kj->k", C, P, C)
    return np.einsum("ki,ki->k", C, x), np.maximum(variance, 0.0)
