"""The motion to begin with: the smoother's, trial after trial."""

from collections.abc import Sequence

import numpy as np

from arm.model import Arm, Floats
from fitter.diagnosis.sensors.frames import FRAME_RATE_HZ, TrialFrames
from limbcal.errors import DataError
from tracking.smoother import Smoother


def first_motions(arm: Arm, trials: Sequence[TrialFrames]) -> list[Floats]:
    """Return spline coefficients (n + 2, n_joint) of every trial; the arm is at its zero where the run begins.

    A motion that the smoother cannot find at all begins as a standstill.
    """
    q = np.zeros(arm.n_joint)
    motions = []
    for trial in trials:
        try:
            states = Smoother(arm, q, trial.continues).smooth(trial.raw.readings(FRAME_RATE_HZ)).states
            path = states[np.minimum(np.arange(len(trial.values)), len(states) - 1), : 3 * arm.n_joint : 3]
        except DataError:
            path = np.tile(q, (len(trial.values), 1))
        motions.append(np.vstack([2.0 * path[0] - path[1], path, 2.0 * path[-1] - path[-2]]))
        q = path[-1]
    return motions
