"""How wrong an arm with its effects is on trials that it was not fitted to: by torque, and by simulated motion."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_erosion, gaussian_filter1d

from arm.effects.effect_table import ROTOR, changed, effect_table
from arm.model import Arm, Floats
from arm.newton_euler import mass_matrix
from arm.simulation import simulate
from fitter.diagnosis.least_squares import CONFIDENCE, N_DRAWN, ROUNDED
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.whitening import CUT_S
from fitter.dynamics.evaluation import HORIZON_S
from fitter.side_by_side import side_by_side

#: A simulated angle that is this far off has run away: less than a millionth of a turn is left in it [rad].
_RUN_AWAY = 1.0 / np.sqrt(ROUNDED)
#: The first state of a trial at rest is the mean over this long [s].
_REST_S = 0.04


@dataclass(frozen=True)
class Errors:
    """What a model gets wrong on some trials.

    Attributes
    ----------
    torque_square : (n_trial, n_joint)
        Sum of squares of the torque that it leaves unexplained while the joint moves, as far up in frequency as
        the noise of differentiated angles lets it be seen.
    torque_count : (n_trial, n_joint)
    unfiltered_square : (n_trial, n_joint), or None
        The same of the torque as it was measured, noise included; None where none was.
    angle_square, angle_sum, angle_max : (n_trial,)
        Of simulated against measured angles of joints that turn [rad]; infinite where the simulation ran away.
    angle_count : (n_trial,)
    simulated : sequence of (n_sample, n_joint)
        The angles of each trial.
    """

    torque_square: Floats
    torque_count: Floats
    unfiltered_square: Floats | None
    angle_square: Floats
    angle_sum: Floats
    angle_max: Floats
    angle_count: Floats
    simulated: Sequence[Floats]

    @property
    def torque_rms(self) -> Floats:
        """Of every joint, (n_joint,)."""
        return self._rms(self.torque_square)

    @property
    def unfiltered_rms(self) -> Floats | None:
        """Of every joint's torque as it was measured, (n_joint,)."""
        return None if self.unfiltered_square is None else self._rms(self.unfiltered_square)

    def _rms(self, square: Floats) -> Floats:
        return np.asarray(np.sqrt(square.sum(axis=0) / np.maximum(self.torque_count.sum(axis=0), 1.0)))

    @property
    def angle_mean_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(self.angle_sum.sum() / max(self.angle_count.sum(), 1.0)))

    @property
    def angle_rms_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(np.sqrt(self.angle_square.sum() / max(self.angle_count.sum(), 1.0))))

    @property
    def angle_max_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(self.angle_max.max(initial=0.0)))

    def only(self, which: Sequence[int]) -> "Errors":
        """Return the errors of some of the trials."""
        some = list(which)
        raw = self.unfiltered_square
        return Errors(
            self.torque_square[some],
            self.torque_count[some],
            None if raw is None else raw[some],
            self.angle_square[some],
            self.angle_sum[some],
            self.angle_max[some],
            self.angle_count[some],
            [self.simulated[k] for k in some],
        )

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        raw, sizes = self.unfiltered_rms, {"mean": self.angle_mean_deg, "rms": self.angle_rms_deg}
        return {
            "torque_rms_N_m": self.torque_rms.tolist(),
            "torque_rms_unfiltered_N_m": None if raw is None else raw.tolist(),
            "angle_error_deg": {
                name: size if np.isfinite(size) else None
                for name, size in (*sizes.items(), ("max", self.angle_max_deg))
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


def unfiltered(left: Floats, motion: Motion) -> Floats | None:
    """Return the torque that is left of what was measured, its noise included; None where none was measured.

    Parameters
    ----------
    left : (n_sample, n_joint)
        The same behind the filter of the trial's columns, see `torque_left`.
    motion : Motion
        Not thinned.
    """
    trial = motion.trial
    return None if trial.tau is None or trial.tau_measured is None else left + trial.tau_measured - trial.tau


def judged(
    regression: Regression, fitted: Candidate, arm: Arm, motions: Sequence[Motion], horizon_s: float = HORIZON_S
) -> Errors:
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
    horizon_s : float
        With measured or no torque, how long a simulation runs before it starts anew from the data.
    """
    turning = np.array([joint.type == "revolute" for joint in arm.joints])
    torque, raw, angle = list[Floats](), list[Floats](), []
    angles = side_by_side(lambda motion: simulated(arm, motion, horizon_s), motions)
    for motion, followed in zip(motions, angles, strict=True):
        left = torque_left(regression, fitted, motion)
        seen = smooth(left, motion.dt_s, regression.weighting.seen_hz)
        torque.append(np.array([np.nansum(seen**2, axis=0), np.sum(np.isfinite(seen), axis=0)]))
        whole = unfiltered(np.where(np.isfinite(seen), left, np.nan), motion)
        if whole is not None:
            raw.append(np.nansum(whole**2, axis=0))
        off = np.abs(followed - motion.trial.q)[:, turning]
        off = np.where(off < _RUN_AWAY, off, np.inf)
        angle.append((np.sum(off**2), np.sum(off), off.max(initial=0.0), off.size))
    squares, sums, worst, count = (np.array(column) for column in zip(*angle, strict=True))
    driven = any(np.any(motion.u) for motion in motions)
    return Errors(
        np.array(torque)[:, 0],
        np.array(torque)[:, 1],
        np.array(raw) if driven and len(raw) == len(motions) else None,
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
    draws = rng.integers(0, n, (N_DRAWN, n))

    def fell(was: Floats, became: Floats) -> Floats:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(1.0 - np.sqrt(became / was), dtype=np.float64)

    was, became = before.torque_square.sum(axis=1), after.torque_square.sum(axis=1)
    low, high = np.nanquantile(
        fell(was[draws].sum(axis=1), became[draws].sum(axis=1)), 0.5 + 0.5 * CONFIDENCE * np.array([-1.0, 1.0])
    )
    angle = float(fell(before.angle_square.sum(), after.angle_square.sum()))
    return Gain(float(fell(was.sum(), became.sum())), angle, (float(low), float(high)))


def smooth(left: Floats, dt_s: float, corner_hz: float) -> Floats:
    """Return what of a torque is slower than a corner, as a mean of what is known: gaps are not bridged.

    Next to a gap the columns' own filter still has part of what is in it.
    """
    margin = np.ones((2 * max(1, round(CUT_S / dt_s)) + 1, 1), dtype=np.bool_)
    known = binary_erosion(np.isfinite(left), margin, border_value=True)
    width = np.sqrt(np.log(2.0)) / (2.0 * np.pi * corner_hz * dt_s)  # its power is halved at the corner
    total = gaussian_filter1d(np.where(known, left, 0.0), width, axis=0, mode="constant")
    weight = gaussian_filter1d(known.astype(np.float64), width, axis=0, mode="constant")
    return np.where(known, total / np.maximum(weight, ROUNDED), np.nan)


def simulated(arm: Arm, motion: Motion, horizon_s: float) -> Floats:
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
    stuck, own = motion.stuck, np.arange(arm.n_joint)
    inner = changed(arm)
    M = mass_matrix(inner, motion.q)
    M[stuck[:, :, None] | stuck[:, None, :]] = 0.0
    M[:, own, own] += np.where(stuck, 1.0, effect_table(inner, motion.number).numbers[ROTOR])
    return bool(np.linalg.eigvalsh(M).min(initial=np.inf) > 0.0)
