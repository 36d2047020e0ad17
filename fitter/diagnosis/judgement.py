"""How wrong a simulation is on trials that it was not fitted to: by torque, and by motion under the law."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_erosion, gaussian_filter1d

from arm.effects.effect_table import ROTOR, changed, effect_table
from arm.model import Arm, Floats
from arm.newton_euler import mass_matrix
from arm.simulation import simulate
from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.dynamics.evaluation import HORIZON_S
from fitter.side_by_side import side_by_side

#: Trials are drawn anew so often for an interval.
_RESAMPLED = 1000
#: A simulated angle that is this far off has run away [rad].
_RUN_AWAY = 1e6
#: Whether there is mass is asked of every so manieth sample.
_EVERY = 10
#: The first state of a trial at rest is the mean over this long [s].
_REST_S = 0.04
#: Next to a gap the columns' own filter still has part of what is in it [s].
_MARGIN_S = 0.05
#: Width of the Gaussian that halves the power at 1 Hz [s].
_WIDTH_S = np.sqrt(np.log(2.0)) / (2.0 * np.pi)


@dataclass(frozen=True)
class Errors:
    """What a model gets wrong on some trials.

    Attributes
    ----------
    torque_square : (n_trial, n_joint)
        Sum of squares of the torque that it leaves unexplained while the joint moves, as far up in frequency as
        the noise of differentiated angles lets it be seen.
    torque_count : (n_trial, n_joint)
    angle_square, angle_sum, angle_max : (n_trial,)
        Of simulated against measured angles of joints that turn [rad]; infinite where the simulation ran away.
    angle_count : (n_trial,)
    simulated : sequence of (n_sample, n_joint)
        The angles of each trial.
    """

    torque_square: Floats
    torque_count: Floats
    angle_square: Floats
    angle_sum: Floats
    angle_max: Floats
    angle_count: Floats
    simulated: Sequence[Floats]

    @property
    def torque_rms(self) -> Floats:
        """Of every joint, (n_joint,)."""
        return np.asarray(np.sqrt(self.torque_square.sum(axis=0) / np.maximum(self.torque_count.sum(axis=0), 1.0)))

    @property
    def angle_mean_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(self.angle_sum.sum() / max(self.angle_count.sum(), 1.0)))

    @property
    def angle_max_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(self.angle_max.max(initial=0.0)))

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        mean, worst = self.angle_mean_deg, self.angle_max_deg
        return {
            "torque_rms_N_m": self.torque_rms.tolist(),
            "angle_error_deg": {
                "mean": mean if np.isfinite(mean) else None,
                "max": worst if np.isfinite(worst) else None,
            },
        }


@dataclass(frozen=True)
class Gain:
    """By which share the rms error fell: of torque and of angle; with an interval of the former."""

    torque: float
    angle: float
    ci95: tuple[float, float]

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        return {
            "torque": self.torque,
            "angle": self.angle if np.isfinite(self.angle) else None,
            "ci95": list(self.ci95),
        }


def torque_left(regression: Regression, fitted: Candidate, motion: Motion) -> Floats:
    """Return the torque that a model leaves of what was measured, NaN while stuck, (n_sample, n_joint)."""
    return np.where(motion.stuck, np.nan, regression.equations.left(fitted.model, fitted.x, motion))


def simulated(arm: Arm, motion: Motion, horizon_s: float = HORIZON_S) -> Floats:
    """Return the angles of an arm with its effects, driven as in a trial, (n_sample, n_joint).

    Under a control law it runs through the whole trial; with measured torque it starts anew every ``horizon_s``.
    Infinite where masses that none can have would run from a push towards where it comes from.
    """
    trial = motion.trial
    if not _has_mass(arm, motion):
        return np.where(np.arange(len(trial.q))[:, None] == 0, trial.q, np.inf)
    t0 = float(motion.t[0])
    if arm.control.law != "measured" and trial.ref is not None:
        rest = max(1, round(_REST_S / trial.dt_s))
        still = motion.stuck[0]
        q0 = np.where(still, trial.q[:rest].mean(axis=0), trial.q[0])
        dq0 = np.where(still, 0.0, trial.dq[0])
        return simulate(arm, trial.ref, trial.dt_s, q0, dq0, t0_s=t0, trial=motion.number, drives=trial.drives).q
    angles = trial.q.copy()
    torque = motion.u if len(motion.u) == len(trial.q) else np.asarray(trial.tau)
    stride = max(1, round(horizon_s / trial.dt_s))
    for start in range(0, len(trial.q) - 1, stride):
        part = slice(start, min(start + stride + 1, len(trial.q)))
        angles[start + 1 : part.stop] = simulate(
            arm,
            trial.q[part],
            trial.dt_s,
            trial.q[start],
            np.where(motion.stuck[min(start, len(motion.stuck) - 1)], 0.0, trial.dq[start]),
            torque=torque[part],
            t0_s=t0 + start * trial.dt_s,
            trial=motion.number,
        ).q[1:]
    return angles


def _has_mass(arm: Arm, motion: Motion) -> bool:
    """Say whether the mass matrix of the joints that move, rotors included, is positive definite all the way."""
    stuck, own = motion.stuck[::_EVERY], np.arange(arm.n_joint)
    inner = changed(arm)
    M = mass_matrix(inner, motion.q[::_EVERY])
    M[stuck[:, :, None] | stuck[:, None, :]] = 0.0
    M[:, own, own] += np.where(stuck, 1.0, effect_table(inner, motion.number).numbers[ROTOR])
    return bool(np.linalg.eigvalsh(M).min(initial=np.inf) > 0.0)


def judged(regression: Regression, fitted: Candidate, arm: Arm, motions: Sequence[Motion]) -> Errors:
    """Return what a model gets wrong.

    Parameters
    ----------
    regression : Regression
    fitted : Candidate
        The model, by its equations.
    arm : Arm
        The same, to be simulated.
    motions : sequence of Motion
        Not thinned.
    """
    turning = np.array([joint.type == "revolute" for joint in arm.joints])
    torque, angle = [], []
    angles = side_by_side(lambda motion: simulated(arm, motion), motions)
    for motion, followed in zip(motions, angles, strict=True):
        left = torque_left(regression, fitted, motion)
        seen = smooth(left, motion.dt_s, regression.weighting.seen_hz)
        torque.append((np.nansum(seen**2, axis=0), np.sum(np.isfinite(seen), axis=0)))
        off = np.abs(followed - motion.trial.q)[:, turning]
        off = np.where(off < _RUN_AWAY, off, np.inf)
        angle.append((np.sum(off**2), np.sum(off), off.max(initial=0.0), off.size))
    squares, sums, worst, count = (np.array(column) for column in zip(*angle, strict=True))
    return Errors(
        np.array([square for square, _ in torque]),
        np.array([number for _, number in torque], dtype=np.float64),
        squares,
        sums,
        worst,
        count.astype(np.float64),
        angles,
    )


def gain(before: Errors, after: Errors) -> Gain:
    """Return by how much a model became better, trials drawn anew for the interval."""
    rng = np.random.default_rng(0)
    n = len(before.torque_square)
    draws = rng.integers(0, n, (_RESAMPLED, n))

    def fell(was: Floats, became: Floats) -> Floats:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(1.0 - np.sqrt(became / was), dtype=np.float64)

    was, became = before.torque_square.sum(axis=1), after.torque_square.sum(axis=1)
    low, high = np.nanquantile(fell(was[draws].sum(axis=1), became[draws].sum(axis=1)), [0.025, 0.975])
    angle = float(fell(before.angle_square.sum(), after.angle_square.sum()))
    return Gain(float(fell(was.sum(), became.sum())), angle, (float(low), float(high)))


def smooth(left: Floats, dt_s: float, corner_hz: float) -> Floats:
    """Return what of a torque is slower than a corner, as a mean of what is known: gaps are not bridged."""
    margin = np.ones((2 * max(1, round(_MARGIN_S / dt_s)) + 1, 1), dtype=np.bool_)
    known = binary_erosion(np.isfinite(left), margin, border_value=True)
    width = _WIDTH_S / corner_hz / dt_s
    total = gaussian_filter1d(np.where(known, left, 0.0), width, axis=0, mode="constant")
    weight = gaussian_filter1d(known.astype(np.float64), width, axis=0, mode="constant")
    return np.where(known, total / np.maximum(weight, 1e-12), np.nan)
