"""The least error that any unbiased estimate of the dynamics can have, from angles with white noise.

The Cramér–Rao bound: with J the slopes of the simulated angles, in units of the noise, no covariance is below
``(J^T J)^-1``. Besides the base parameters each trial's start is unknown; what they take away counts.
"""

from collections.abc import Sequence

import numpy as np

from arm.base_parameters import base_parameters, with_base_values
from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from arm.simulation import simulate
from fitter.data.trial import Trial

#: Slopes are central differences over this much of a parameter or a start [SI].
_STEP = 1e-4


def least_std(arm: Arm, trials: Sequence[Trial], noise_rad: Floats, samples: int) -> Floats:
    """Return the least standard errors of the base parameters.

    Parameters
    ----------
    arm : Arm
        The true one, with its control law.
    trials : sequence of Trial
        Its true motions with their targets, at any rate that shows the motion.
    noise_rad : (n_joint,)
        Standard deviation of the white noise of one sample.
    samples : int
        How many samples were measured of all these trials together.

    Returns
    -------
    (n_base,)
    """
    base = base_parameters(arm)
    values = base.combination @ standard_parameters(arm)
    steps = _STEP * np.eye(len(values))
    moved = [[with_base_values(arm, base, values + sign * step) for sign in (1.0, -1.0)] for step in steps]
    shifts = _STEP * np.eye(arm.n_joint)
    information, count = np.zeros((len(values), len(values))), 0
    for trial in trials:
        q0, dq0 = trial.q[0], trial.dq[0]
        J = np.column_stack([(_angles(up, trial, q0, dq0) - _angles(down, trial, q0, dq0)) for up, down in moved])
        own = np.column_stack(
            [_angles(arm, trial, q0 + s, dq0) - _angles(arm, trial, q0 - s, dq0) for s in shifts]
            + [_angles(arm, trial, q0, dq0 + s) - _angles(arm, trial, q0, dq0 - s) for s in shifts]
        )
        J, own = (part / (2.0 * _STEP) / np.tile(noise_rad, len(trial.t))[:, None] for part in (J, own))
        J = J - own @ np.linalg.lstsq(own, J, rcond=None)[0]
        information += J.T @ J
        count += len(trial.t)
    covariance = np.linalg.inv(information * samples / count)
    return np.asarray(np.sqrt(np.diag(covariance)), dtype=np.float64)


def _angles(arm: Arm, trial: Trial, q0: Floats, dq0: Floats) -> Floats:
    """Return all simulated angles of a trial in one row."""
    assert trial.ref is not None
    return simulate(arm, trial.ref, trial.dt_s, q0, dq0).q.ravel()
