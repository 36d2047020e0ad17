"""How far a simulated arm goes astray: angles simulated over windows against those that were measured."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats
from fitter.data.trials import Trial
from fitter.diagnosis.simulated_motion.numbers import numbers_of
from fitter.diagnosis.simulated_motion.shooting import ShootingWithEffects, horizons
from fitter.dynamics.structure import structural_parameters
from fitter.side_by_side import processors

#: A simulated joint that is this far off [rad or m] has run away: half a million turns.
_RUN_AWAY = 3e6


@dataclass(frozen=True)
class ForwardError:
    """Simulated against measured angles of joints that turn (where none does, of those that slide).

    Attributes
    ----------
    mean, rms, max : (n_trial,) [rad or m]
        Over the samples and joints of each trial; infinite where a simulation ran away.
    count : (n_trial,)
        Samples times joints.
    angles : sequence of (n_sample, n_joint)
        The simulated angles of each trial.
    """

    mean: Floats
    rms: Floats
    max: Floats
    count: Floats
    angles: Sequence[Floats]

    @property
    def total_mean(self) -> float:
        """Over all trials [rad or m]."""
        return float(np.sum(self.mean * self.count) / np.sum(self.count))

    @property
    def total_rms(self) -> float:
        """Over all trials [rad or m]."""
        return float(np.sqrt(np.sum(self.rms**2 * self.count) / np.sum(self.count)))

    @property
    def total_max(self) -> float:
        """Over all trials [rad or m]."""
        return float(self.max.max())


def forward_error(arm: Arm, trials: Sequence[Trial], horizon_s: float, first: int = 1) -> ForwardError:
    """Return how far an arm with its effects goes astray.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
    horizon_s : float
        With measured torque or none, how long a simulation runs before it starts anew from the trial's state;
        under a control law it runs from a trial's first state to its end.
    first : int
        The number of the first trial in its run, counted from 1.
    """
    numbers = numbers_of(arm, structural_parameters(arm))
    shooting, cut = ShootingWithEffects(numbers, len(trials), first), horizons(arm, trials, horizon_s)
    machine = shooting.machine(numbers.values)
    with ThreadPoolExecutor(processors(len(cut))) as pool:
        shot = list(pool.map(lambda one: shooting.angles(machine, one, one.start), cut))
    turning = np.array([joint.type == "revolute" for joint in arm.joints])
    turning |= not turning.any()
    angles, off = [], []
    for k, trial in enumerate(trials):
        parts = [q[1:] for q, one in zip(shot, cut, strict=True) if one.trial == k]
        angles.append(np.vstack([trial.q[:1], *parts]))
        wrong = np.abs(angles[-1] - trial.q)[:, turning]
        off.append(np.where(wrong < _RUN_AWAY, wrong, np.inf))
    return ForwardError(
        np.array([one.mean() for one in off]),
        np.array([np.sqrt(np.mean(one**2)) for one in off]),
        np.array([one.max() for one in off]),
        np.array([one.size for one in off], dtype=np.float64),
        angles,
    )
