"""Trials made into motions: on the run's clock, where a joint moves, and how fast.

Friction needs velocity behind filters that neither ring nor are slow, with the noise that they leave.
"""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import binary_dilation, gaussian_filter1d, maximum_filter1d

from arm.model import Arm, Floats
from fitter.data.jumps import jumps
from fitter.data.trial import Trial
from fitter.diagnosis.cutoff import noise_of_angles
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, SIGMAS
from fitter.diagnosis.motion import SAMPLES, Motion, drive_torque, sharp_torque
from fitter.diagnosis.whitening import lasting

#: The direction in which a joint moves is determined behind a Gaussian of this width [s]: unlike a sharp filter
#: it does not ring, so nothing seems to move the other way before it starts.
_DIRECTION_S = 0.006


def velocity(trial: Trial, times: float = 1.0) -> Floats:
    """Return the velocity behind a Gaussian whose width is multiplied by ``times``, (n_sample, n_joint)."""
    width = times * _width(trial.dt_s) / trial.dt_s
    if "q" not in trial.whole:
        return np.asarray(gaussian_filter1d(trial.dq, width, axis=0, mode="nearest"), dtype=np.float64)
    slopes = gaussian_filter1d(trial.whole["q"], width, axis=0, order=1, mode="nearest") / trial.dt_s
    return np.asarray(slopes[trial.trimmed : trial.trimmed + len(trial.t)], dtype=np.float64)


def significant_velocity(
    trial: Trial, noise: Floats, least: Floats, wider: tuple[float, ...] = (4.0, 2.0)
) -> tuple[Floats, Floats]:
    """Return the velocity where a joint is seen to move, 0 elsewhere, and its rms noise, (n_sample, n_joint) each.

    A wide filter sees slow motion, and blurs when it began: so the velocity it shows counts only where it is far
    from changing its sign.

    Parameters
    ----------
    trial : Trial
    noise : (n_joint,)
        Rms of the white noise in the angles [rad or m].
    least : (n_joint,)
        Slower joints rest.
    wider : tuple of float
        Multiples of the narrow filter's width where a joint is slow: noise falls eightfold with each octave.
    """
    found, std = np.zeros((2, *trial.dq.shape))
    # Twice the significant velocity is slow. The wider filter says so, for the noisier would choose by its noise.
    slow = 2.0 * SIGMAS * noise * velocity_gain(trial.dt_s)
    for times in (*wider, 1.0):
        moves, own = velocity(trial, times), noise * velocity_gain(trial.dt_s, times)
        sure, may = np.abs(moves), found == 0.0
        if times > 1.0:
            may &= sure < slow
            # It must not change its sign within what the filter reaches.
            sure -= EQUAL_SIGMAS * times * _width(trial.dt_s) * np.abs(np.gradient(moves, trial.dt_s, axis=0))
        else:
            sure -= _blurred(moves, own, trial.dt_s)
        is_significant = may & (sure > np.maximum(least, SIGMAS * own))
        found, std = np.where(is_significant, moves, found), np.where(is_significant, own, std)
    return found, std


def _between(seen: Floats, part: Floats) -> Floats:
    """Return a part of every joint's motion, on a straight line where it is not seen to move, (n_sample, n_joint).

    A joint that is lost in noise for less than a rest lasts goes on as it did, or turns round on its way.
    """
    filled, samples = part.copy(), np.arange(len(part))
    for j, is_seen in enumerate((seen != 0.0).T):
        if np.any(is_seen):
            filled[~is_seen, j] = np.interp(samples[~is_seen], samples[is_seen], part[is_seen, j])
    return filled


def _blurred(moves: Floats, noise: Floats, dt_s: float) -> Floats:
    """Return the speed that a short rest seems to have behind the narrow filter, (n_sample, n_joint).

    The filter spreads what happens around a rest into it: a ramp of the velocity that ends there is still seen
    half a width times the acceleration high.
    """
    width = _width(dt_s)
    steep = np.abs(np.gradient(moves, dt_s, axis=0)) - SIGMAS * np.sqrt(1.5) / width * noise
    around = 2 * round(SIGMAS * width / dt_s) + 1
    return np.asarray(0.5 * width * maximum_filter1d(np.maximum(steep, 0.0), around, axis=0), dtype=np.float64)


def velocity_gain(dt_s: float, times: float = 1.0) -> float:
    """Return the rms of `velocity` per rms of white noise in the angle [1/s]."""
    return float(np.sqrt(dt_s / (4.0 * np.sqrt(np.pi) * (times * _width(dt_s)) ** 3)))


def sharper(dq: Floats, dt_s: float) -> Floats:
    """Return a velocity with what its Gaussian took off it put back but for a little (Tukey's twicing).

    Resistance by the square of a speed that was blurred would seem a percent too strong.
    """
    return np.asarray(
        2.0 * dq - gaussian_filter1d(dq, _width(dt_s) / dt_s, axis=0, mode="nearest"), dtype=np.float64
    )


def sharper_gain(dt_s: float) -> float:
    """Return the rms of `sharper` of `velocity` per rms of white noise in the angle [1/s]."""
    width = _width(dt_s) / dt_s
    impulse = np.zeros((2 * round(10 * width) + 1, 1))
    impulse[len(impulse) // 2] = 1.0
    slopes = gaussian_filter1d(impulse, width, axis=0, order=1, mode="constant") / dt_s
    return float(np.sqrt(np.sum(sharper(slopes, dt_s) ** 2)))


def _width(dt_s: float) -> float:
    return max(_DIRECTION_S, 1.5 * dt_s)


def run_of(
    arm: Arm,
    learn: Sequence[Trial],
    evaluate: Sequence[Trial],
    thin: bool = True,
    *,
    stuck_share: float = 1e-4,
    near: int = 3,
) -> list[Motion]:
    """Return all trials of a run, learning ones first, on one clock.

    Parameters
    ----------
    arm : Arm
        Its control law gives the torque where none was measured.
    learn, evaluate : sequence of Trial
    thin : bool
        Whether samples may be left out that the corner of the columns makes superfluous.
    stuck_share : float
        A joint is taken to be stuck where noise hides its motion, or, of angles without noise, below this fraction
        of its top speed in the run (mathematics, 14). One that creeps is not: what pushes it shows.
    near : int
        Samples before and after a detected rest at which the joint may have rested, too.

    Raises
    ------
    DataError
        If a trial has neither torque nor a target for the law.
    """
    trials = [*learn, *evaluate]
    angles = noise_of_angles(trials)
    slow = [velocity(trial) for trial in trials]
    top = np.max([np.max(np.abs(dq), axis=0) for dq in slow], axis=0)
    motions = []
    for k, (trial, dq, t0) in enumerate(zip(trials, slow, _starts(trials), strict=True)):
        seen, noise = significant_velocity(trial, angles, stuck_share * top)
        stuck = lasting(seen == 0.0, trial.dt_s)
        moves, noise = np.where(stuck, dq, _between(seen, seen)), _between(seen, noise)
        sharp = moves == dq
        t, u = t0 + trial.t, drive_torque(arm, trial)
        step = max(1, int(1.0 / (SAMPLES * trial.cutoff_hz * trial.dt_s))) if thin else 1
        stuck = binary_dilation(stuck, np.ones((2 * near + 1, 1), dtype=np.bool_))
        q, dq_, ddq, u_, speed, speed_noise, direction = (
            part[::step]
            for part in (
                trial.q,
                trial.dq,
                trial.ddq,
                u,
                np.where(sharp, sharper(dq, trial.dt_s), moves),
                np.where(sharp, angles * sharper_gain(trial.dt_s), noise) * ("q" in trial.whole),
                np.where(stuck, 0.0, np.sign(moves)),
            )
        )
        dt_s = step * trial.dt_s
        motions.append(
            Motion(
                trial,
                k + 1,
                k < len(learn),
                t[::step],
                q,
                dq_,
                ddq,
                u_,
                speed,
                speed_noise,
                direction,
                stuck[::step],
                ~trial.counted[::step],
                dt_s,
                _jumps(arm, trial, step),
            )
        )
    return motions


def _jumps(arm: Arm, trial: Trial, step: int, error: float = 0.1) -> tuple[tuple[float, int, float], ...]:
    """Return the jumps of the torque that was asked for, on the grid of every ``step``-th sample.

    A jump comes at a sample, as far as controller and recorder share a clock; what a fast loop does within the
    step is not seen. Its instant has a standard error of ``error`` samples.
    """
    asked = trial.tau_measured
    if asked is None:
        asked = sharp_torque(arm, trial)[trial.trimmed : trial.trimmed + len(trial.t)]
    size = jumps(asked)
    return tuple(
        (k / step, int(j), error * float(abs(size[k, j])) / step) for k, j in zip(*np.nonzero(size), strict=True)
    )


def _starts(trials: Sequence[Trial]) -> list[float]:
    """Return each trial's first instant on the run's clock [s].

    The file's clocks go on if no trial begins before the end of the one before, but for a period of the corner.
    """
    began = [trial.began_s for trial in trials]
    ends = [trial.began_s + trial.t[-1] - 1.0 / trial.cutoff_hz for trial in trials]
    if all(b >= e for b, e in zip(began[1:], ends[:-1], strict=True)):
        return began
    starts, t = [], 0.0
    for trial in trials:
        ends_cut = trial.trimmed * trial.dt_s
        starts.append(t + ends_cut)
        t += trial.t[-1] + trial.dt_s + 2 * ends_cut
    return starts
