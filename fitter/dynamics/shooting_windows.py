"""Trials cut into windows that a simulation is shot through, each from a start of its own.

Under a control law a trial is one window: the law pulls the simulation back to the target, and all of the trial
tells. With measured torque nothing pulls it back; errors grow, without bound where the arm can fall, so a trial is
cut into windows (multiple shooting; Bock 1983). The starts are free: what joins the windows is the arm alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.drive_state import DriveState, drives_of, unchanging
from arm.model import Arm, Control, Floats
from fitter.data.torque_target import has_unknown_target, target_holds_from, target_of, torque_target
from fitter.data.trial import Trial

#: Angles are averaged over, and simulated in, steps no longer than this: the arm hardly moves in one.
LONGEST_STEP_S = 2e-3


@dataclass(frozen=True)
class ShootingWindow:
    """A part of a trial, on the grid of its simulation.

    Attributes
    ----------
    trial : int
        Which trial it is part of.
    dt_s : float
    drive : (n_sample, n_joint)
        The controller's target, held through each step, or the torque at its beginning.
    measured : (n_sample, n_joint) [rad or m]
        Angles, averaged over the step around each instant.
    start : (n_start,)
        Angles and velocities at the first instant, and where it is unknown the target: what a search begins with.
    drives : DriveState, or None
        Under a law: gains of the trial's own, and where the drives are engaged, in each step.
    began_s : float
        The run's time at the first instant [s].
    start_std : (n_start,), optional
        Standard errors of ``start``; without them nothing but the window itself says where it starts.
    """

    trial: int
    dt_s: float
    drive: Floats
    measured: Floats
    start: Floats
    drives: DriveState | None = None
    began_s: float = 0.0
    start_std: Floats | None = None

    def schedule(self, control: Control) -> Floats:
        """Return the gains of every step, as a simulation takes them; none where they are the law's throughout."""
        return unchanging(self.measured.shape[1]) if self.drives is None else self.drives.schedule(control)

    @property
    def free_target(self) -> bool:
        """Whether the target is one unknown constant, the last part of ``start``."""
        return bool(len(self.start) == 3 * self.measured.shape[1])


def shooting_windows(
    arm: Arm, trials: Sequence[Trial], step_s: float, window_s: float = np.inf
) -> list[ShootingWindow]:
    """Cut trials into what is simulated in one go.

    Parameters
    ----------
    arm : Arm
        Its law drives it, or the torque of the trials.
    trials : sequence of Trial
    step_s : float
        Step of the simulation, rounded to a whole number of samples.
    window_s : float
        Longest window. Infinite leaves trials whole.

    Raises
    ------
    DataError
        If a trial lacks what drives it.
    """
    cut = []
    for number, trial in enumerate(trials):
        stride = max(1, int(step_s / trial.dt_s + 1e-9))
        whole = dict(trial.whole) or _columns(trial)
        begin = 0
        if has_unknown_target(arm, trial):
            begin = (trial.trimmed if trial.whole else 0) + target_holds_from(trial)
            whole["ref"] = np.tile(target_of(arm, trial)[-1], (len(whole["q"]), 1))
        if "ref" in whole and stride > 1 and len(whole["ref"]) > begin + 1:
            jump = int(np.argmax(np.abs(np.diff(whole["ref"][begin:], axis=0)).max(axis=1))) + 1
            begin += jump % stride  # the target's jump lies between two steps, not in one
        measured = _centred(whole["q"], begin, stride) - _bulge(trial, begin, stride)
        drive = _drive(arm, trial, whole, begin, stride)
        drives = drives_of(trial.whole) if trial.whole else trial.drives
        at = np.minimum(begin + stride * np.arange(len(drive)) + stride // 2, len(whole["q"]) - 1)
        switched = None if drives is None or arm.control.law == "measured" else drives.rows(at)
        n = min(len(drive), len(measured))
        parts = max(1, round(n * stride * trial.dt_s / window_s)) if np.isfinite(window_s) else 1
        edges = np.linspace(0, n - 1, parts + 1).astype(int)
        for first, last in zip(edges[:-1], edges[1:], strict=True):
            if last - first > 4:  # fewer samples say no more than their own start
                start = [measured[first], _velocity(trial, whole["q"], begin + first * stride)]
                if has_unknown_target(arm, trial):
                    start.append(drive[first])
                window = slice(first, last + 1)
                own = None if switched is None else switched.rows(window)
                begins, dt_s = np.concatenate(start), stride * trial.dt_s
                since = begin + int(first) * stride - (trial.trimmed if trial.whole else 0)
                began_s = trial.began_s + since * trial.dt_s
                cut.append(ShootingWindow(number, dt_s, drive[window], measured[window], begins, own, began_s))
    return cut


def _drive(arm: Arm, trial: Trial, whole: Mapping[str, Floats], begin: int, stride: int) -> Floats:
    if arm.control.law == "measured":
        torque_target(arm, trial)  # says it if there is none
        return _centred(whole["tau"], begin, stride)
    target = whole["ref"][begin:]
    n = len(target) // stride
    # A target that changes within a step acts in the mean as it did; what remains is of second order.
    return np.asarray(target[: n * stride].reshape(n, stride, -1).mean(axis=1), dtype=np.float64)


def _bulge(trial: Trial, begin: int, stride: int) -> Floats:
    """Return by how much a mean over one step is off on a curved path: half the curvature times the spread."""
    trimmed = trial.trimmed if trial.whole else 0
    inner = np.arange(begin, len(trial.q) + 2 * trimmed, stride) - trimmed
    known = (inner >= 0) & (inner < len(trial.ddq))
    ddq = np.where(known[:, None], trial.ddq[np.clip(inner, 0, len(trial.ddq) - 1)], 0.0)
    offset = np.arange(-(stride // 2), stride // 2 + 1)
    weight = np.where(2 * np.abs(offset) == stride, 0.5, 1.0) / stride
    return np.asarray(0.5 * ddq * trial.dt_s**2 * float(weight @ offset**2), dtype=np.float64)


def _velocity(trial: Trial, q: Floats, at: int) -> Floats:
    """Return roughly how fast the joints are at a sample of the whole trial."""
    inner = at - (trial.trimmed if trial.whole else 0)
    if 0 <= inner < len(trial.dq):
        return np.asarray(trial.dq[inner], dtype=np.float64)
    some = np.arange(max(2, trial.trimmed // 2))  # there is no derivative in what was trimmed: a straight line
    start = min(at, len(q) - len(some))
    slope = np.polyfit(trial.dt_s * some, q[start : start + len(some)], 1)[0]
    return np.asarray(slope, dtype=np.float64)


def _columns(trial: Trial) -> dict[str, Floats]:
    columns = {"q": trial.q, "ref": trial.ref, "tau": trial.tau}
    return {name: values for name, values in columns.items() if values is not None}


def _centred(values: Floats, begin: int, stride: int) -> Floats:
    """Return means over one step around every ``stride``-th sample: every sample's noise is averaged."""
    reach = stride // 2
    ends = 0.5 if stride % 2 == 0 else 1.0
    padded = np.pad(values, ((reach, reach), (0, 0)), mode="reflect", reflect_type="odd") if reach else values
    total = np.vstack([np.zeros(values.shape[1]), np.cumsum(padded, axis=0)])
    at = np.arange(begin, len(values), stride)
    inner = total[at + 2 * reach + 1] - total[at]
    if reach:
        inner -= (1.0 - ends) * (padded[at] + padded[at + 2 * reach])
    return np.asarray(inner / stride, dtype=np.float64)
