"""How far a joint's load is off: what the torque equation leaves where the joint moves, in means of any length.

While a joint moves its load is known otherwise: by eq. (8). What that leaves is the noise of the torque, of angles
and their derivatives, what a filter bends, and what the model lacks. The same is in the load of a joint that
stands. Neighbouring samples of it resemble each other, so the scatter of means is measured, not derived from one
sample's.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Arm, Floats
from arm.newton_euler import inverse_dynamics
from fitter.data.derivatives import ORDER, SETTLING_PERIODS, settling_samples
from fitter.data.law_torque import law_torque
from fitter.data.standstill import is_moving, throughout
from fitter.data.trial import Trial

#: A normal deviation's size in units of the median of its absolute value; and of second differences.
_MEDIAN, _SECOND = 1.4826, np.sqrt(6.0)
#: The scatter of means is measured from at least this many that share no sample.
_FEWEST = 10
#: From one length of means to the next.
_LONGER = 1.2
#: Samples to either side that columns without a filter depend on: an acceleration by differences of differences.
_DIFFERENCES = 2


@dataclass(frozen=True)
class LoadNoise:
    """The scatter of means of a joint's load.

    Attributes
    ----------
    lengths : (n,) int
        Means over this many samples, from 1 on.
    scatter : (n,)
        Their standard deviation [N m or N].
    """

    lengths: Floats
    scatter: Floats

    def of_means(self, length: int) -> float:
        """Return the standard deviation of means over this many samples: of the longest that was measured."""
        return float(self.scatter[np.searchsorted(self.lengths, length, side="right") - 1])


def load_noise(arm: Arm, trials: Sequence[Trial], i: int) -> LoadNoise:
    """Return the scatter of a joint's load, from what eq. (8) leaves of the torque where the joint moves.

    Parameters
    ----------
    arm : Arm
        A calibrated one.
    trials : sequence of Trial
        Each says what drives the arm.
    i : int
        The joint, from 0.
    """
    parts: list[Floats] = []
    white = []
    for trial in trials:
        residual = (driving_torque(arm, trial) - inverse_dynamics(arm, trial.q, trial.dq, trial.ddq))[:, i]
        white.append(white_noise(residual))
        moving = throughout(is_moving(trial.dq[:, i]) & trial.counted[:, i], reach_of(trial))
        edges = np.flatnonzero(np.diff(np.concatenate([[False], moving, [False]]).astype(int)))
        parts += [residual[first:last] for first, last in zip(edges[::2], edges[1::2], strict=True)]
    least = float(np.median(white)) if white else 0.0
    lengths, scatter, length = [1], [least], 1
    while sum(len(part) // length for part in parts) >= _FEWEST:
        means = [part[: len(part) // length * length].reshape(-1, length).mean(axis=1) for part in parts]
        rms = float(np.sqrt(np.mean(np.concatenate(means) ** 2)))
        lengths.append(length)
        scatter.append(max(rms, least / np.sqrt(length)))
        length = max(length + 1, round(_LONGER * length))
    return LoadNoise(np.array(lengths), np.array(scatter))


def reach_of(trial: Trial) -> int:
    """Return how many samples to either side a trial's columns depend on."""
    return settling_samples(trial.dt_s, trial.cutoff_hz) if trial.whole else _DIFFERENCES


def leaks(trial: Trial) -> float:
    """Return which fraction of a motion its filter shows as far away as `reach_of`: its slowest pole's decay."""
    if not trial.whole or reach_of(trial) == 0:
        return 0.0
    return float(np.exp(-2.0 * np.pi * np.sin(np.pi / (2 * ORDER)) * SETTLING_PERIODS))


def driving_torque(arm: Arm, trial: Trial, standing: int | None = None) -> Floats:
    """Return what drives an arm, (n_sample, n_joint): the torque, or the law's for a joint that stands."""
    if arm.control.law == "measured":
        assert trial.tau is not None
        return trial.tau
    if standing is None:
        return law_torque(arm.control, trial)
    ddq = trial.ddq.copy()
    ddq[:, standing] = 0.0
    return law_torque(arm.control, replace(trial, ddq=ddq))


def white_noise(values: Floats) -> float:
    """Return the standard deviation of white noise on something smooth, from second differences."""
    bends = np.diff(values, 2)
    return float(_MEDIAN * np.median(np.abs(bends)) / _SECOND) if len(bends) else 0.0
