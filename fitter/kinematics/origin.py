"""What displacements of the tip are counted from: the rest that a trial begins with, or its mean."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from arm.model import Arm, Floats
from fitter.data.first_rest import displacement, first_rest
from fitter.data.trial import Trial
from fitter.kinematics.identifiability import RESOLUTION_M
from fitter.kinematics.noise_floor import NEGLIGIBLE

About = Literal["rest", "mean"]

#: A rest is known to within this [rad or m]: a millimetre at half a metre.
_KNOWN = 2e-3
_FEWEST = 10
_WITHIN = 5.0


def rest_of(trial: Trial, noise: Floats) -> slice | None:
    """Return the samples of the rest that a trial begins with, or None where there is no such rest.

    Parameters
    ----------
    trial : Trial
    noise : (n_joint,) [rad or m]
        Of the measured angles. Where there is any, their derivatives are of no use: then means over as many
        samples as it takes to know an angle are compared with the first such mean.
    """
    if np.all(noise < NEGLIGIBLE):
        rest = first_rest(trial)
        return rest if rest.stop - rest.start >= _FEWEST else None
    size = max(_FEWEST, int(np.ceil((noise.max() / _KNOWN) ** 2)))
    n = len(trial.q) // size
    if n < 2:
        return None
    means = trial.q[: n * size].reshape(n, size, -1).mean(axis=1)
    allowed = _WITHIN * np.sqrt(2.0 / size) * noise + _KNOWN
    moved = np.flatnonzero(np.any(np.abs(means - means[0]) > allowed, axis=1))
    still = int(moved[0]) if len(moved) else n
    return slice(0, still * size) if 1 < still < n else None


def choose_about(trials: Sequence[Trial], noise: Floats | None) -> About:
    """Return "rest" where every trial is a recording or begins with a rest that is distinguishable from noise.

    Parameters
    ----------
    trials : sequence of Trial
    noise : (n_joint,) or None
        Of the measured angles; None where it could not be estimated, since no motion is smooth.
    """

    def rests(trial: Trial) -> bool:
        if trial.points is not None:
            return True
        rest = None if noise is None else rest_of(trial, noise)
        if rest is None or trial.tip is None:
            return False
        tip_noise = trial.tip[rest].std(axis=0).max() / np.sqrt(rest.stop - rest.start)
        return bool(tip_noise < RESOLUTION_M)

    return "rest" if all(rests(trial) for trial in trials) else "mean"


def counted_from_rest(arm: Arm, trial: Trial, noise: Floats) -> tuple[Floats, Floats]:
    """Return how far the tip has come since the rest, and the angles at that rest.

    As `fitter.data.first_rest.displacement`, whose rest it is where the angles have no noise.
    """
    moved, at_rest = displacement(arm, trial)
    rest = None if np.all(noise < NEGLIGIBLE) else rest_of(trial, noise)
    if rest is None:
        return moved, at_rest
    return moved - moved[rest].mean(axis=0), trial.q[rest]
