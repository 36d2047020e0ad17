"""Trials as a diagnosis sees them: on the run's clock, with the drive's torque, and where friction is known."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.stats import norm

from arm.model import Arm, Floats
from fitter.data.jumps import jumps
from fitter.data.law_torque import law_torque
from fitter.data.trials import Trial
from fitter.diagnosis.velocity import sharper, sharper_gain, told_from_rest, velocity
from fitter.diagnosis.whitening import lasting
from limbcal.errors import DataError

#: A joint is taken to be stuck below this share of its top speed in the run, or where noise hides how it moves.
_STUCK_SHARE = 0.004
#: A jump comes at a sample, as far as controller and recorder share a clock; what a fast loop does within the step
#: is not seen. This is the standard error of its instant, in samples.
_JUMPED = 0.1
#: So many samples before and after a joint was seen to be stuck it may have been.
_NEAR = 3
#: Samples a period of the corner that are kept of a motion.
SAMPLES = 5.0


@dataclass(frozen=True)
class Motion:
    """One trial of a run.

    Attributes
    ----------
    trial : Trial
    number : int
        From 1 over the run.
    learn : bool
        Whether it may be learnt from.
    t : (n_sample,) [s]
        The run's time.
    q, dq, ddq, u : (n_sample, n_joint)
        Angles, derivatives, and the torque that the drive was asked for.
    speed : (n_sample, n_joint)
        Velocity behind a filter that is quicker than that of dq: friction near rest changes within milliseconds.
    speed_noise : (n_sample, n_joint)
        Its rms noise, 0 where that is not known.
    direction : (n_sample, n_joint)
        -1, 0 or 1.
    stuck : (n_sample, n_joint) bool
        Where a joint stands still for a while: any torque up to its friction may hold it there.
    dt_s : float
        Step of its grid: `SAMPLES` a period of the columns' corner are enough.
    jumps : tuple of (float, int, float)
        Jumps of the torque: sample, joint, and the standard error of its impulse, for its instant is not known
        exactly; as the torque of one sample [N m or N].
    """

    trial: Trial
    number: int
    learn: bool
    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    u: Floats
    speed: Floats
    speed_noise: Floats
    direction: Floats
    stuck: NDArray[np.bool_]
    dt_s: float
    jumps: tuple[tuple[float, int, float], ...] = ()


def run_of(arm: Arm, learn: Sequence[Trial], evaluate: Sequence[Trial], thin: bool = True) -> list[Motion]:
    """Return all trials of a run, learning ones first, on one clock.

    Parameters
    ----------
    arm : Arm
        Its control law gives the torque where none was measured.
    learn, evaluate : sequence of Trial
    thin : bool
        Whether samples may be left out that the corner of the columns makes superfluous.

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
        seen, noise = told_from_rest(trial, angles, _STUCK_SHARE * top)
        moves = np.where(seen == 0.0, dq, seen)
        sharp = moves == dq
        t, u, stuck = t0 + trial.t, drive_torque(arm, trial), lasting(seen == 0.0, trial.dt_s)
        step = max(1, int(1.0 / (SAMPLES * trial.cutoff_hz * trial.dt_s))) if thin else 1
        stuck = binary_dilation(stuck, np.ones((2 * _NEAR + 1, 1), dtype=np.bool_))
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
                dt_s,
                _jumps(arm, trial, step),
            )
        )
    return motions


def drive_torque(arm: Arm, trial: Trial) -> Floats:
    """Return the torque that the drive was asked for: measured, or by the law, eq. (5), (6), (7).

    Raises
    ------
    DataError
        If there is neither.
    """
    if trial.tau is not None:
        return trial.tau
    if arm.control.law == "measured" or trial.ref is None:
        missing = "columns tau1…, or a control law in the arm file" if trial.ref is not None else "columns tau1…"
        raise DataError(f"trial {trial.name}: nothing says which torque drove it; expected {missing}")
    return law_torque(arm.control, trial)


def sharp_torque(arm: Arm, trial: Trial) -> Floats:
    """Return the torque that was asked for with its jumps, before the column filter, ends included.

    Parameters
    ----------
    arm : Arm
    trial : Trial

    Returns
    -------
    (n_sample + 2 * trimmed, n_joint)
        Measured, or the law's for the smooth motion and the target as it was held.
    """
    if "tau" in trial.whole:
        return trial.whole["tau"]
    u = drive_torque(arm, trial)
    if trial.ref is not None and trial.drives is not None and trial.tau is None:
        u = trial.drives.torque(arm.control, trial.q, trial.dq, trial.ddq, trial.ref)
    elif trial.ref is not None and trial.ref_filtered is not None and trial.tau is None:
        u = u + np.asarray(arm.control.kp) * (trial.ref - trial.ref_filtered)
    return np.pad(u, ((trial.trimmed, trial.trimmed), (0, 0)), mode="edge")


def _jumps(arm: Arm, trial: Trial, step: int) -> tuple[tuple[float, int, float], ...]:
    """Return the jumps of the torque that was asked for, on the grid of every ``step``-th sample."""
    asked = trial.tau_measured
    if asked is None:
        asked = sharp_torque(arm, trial)[trial.trimmed : trial.trimmed + len(trial.t)]
    size = jumps(asked)
    return tuple(
        (k / step, int(j), _JUMPED * float(abs(size[k, j])) / step) for k, j in zip(*np.nonzero(size), strict=True)
    )


def noise_of_angles(trials: Sequence[Trial]) -> Floats:
    """Return the rms of the white noise in the measured angles, (n_joint,) [rad or m]."""
    return white_noise([trial.whole.get("q", trial.q) for trial in trials])


def white_noise(columns: Sequence[Floats]) -> Floats:
    """Return the rms of what is white in some columns: that of their third differences, robustly.

    Motion has next to nothing in a third difference at these rates; it enlarges white noise by sqrt(20).
    """
    third = np.concatenate([np.diff(values, 3, axis=0) for values in columns])
    return np.asarray(np.median(np.abs(third), axis=0) / norm.ppf(0.75) / np.sqrt(20.0), dtype=np.float64)


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
