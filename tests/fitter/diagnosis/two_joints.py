"""Trials of an arm of two joints with measured torque, small and quick."""

from dataclasses import replace

import numpy as np

from arm.arm_file import load_arm
from arm.model import Arm, Effect
from arm.simulation import simulate
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of

_DT_S, _SECONDS, _ANGLE_RAD, _TORQUE_N_M = 0.004, 3.0, 2e-4, 0.01
#: Steps of the controller, which holds its torque, a sample.
_QUICKER = 40


def two_joints() -> Arm:
    """Return the arm as its file describes it, without effects."""
    return load_arm("dd-arm-vertical")


def measured(*effects: Effect, trials: int = 6, seed: int = 0) -> list[Measured]:
    """Return noisy motions of an arm that has some effects."""
    rng, arm = np.random.default_rng(seed), replace(two_joints(), effects=effects)
    dt_s = _DT_S / _QUICKER
    t, motions = np.arange(round(_SECONDS / dt_s)) * dt_s, []
    for k in range(trials):
        rate = 2.0 * np.pi * rng.uniform(0.3, 1.2, (2, 2))
        phase = rng.uniform(0.0, 2.0 * np.pi, (2, 2))
        ref = 0.4 * np.sin(t[:, None, None] * rate + phase).sum(axis=1)
        motion = simulate(arm, ref, dt_s, ref[0], np.zeros(2), t0_s=k * _SECONDS, trial=k + 1)
        q, tau = motion.q[::_QUICKER], motion.tau[::_QUICKER]
        columns = {
            "q": q + _ANGLE_RAD * rng.normal(size=q.shape),
            "tau": tau + _TORQUE_N_M * rng.normal(size=q.shape),
        }
        motions.append(Measured(f"swing {k + 1}", "test", 0, t[::_QUICKER], columns))
    return motions


def regression_of_two(*effects: Effect, trials: int = 6, seed: int = 0) -> Regression:
    """Return its equations; half of the trials may be learnt from."""
    run = to_trials(measured(*effects, trials=trials, seed=seed), cutoff_hz=25.0)
    return regression_of(two_joints(), run_of(two_joints(), run[: trials // 2], run[trials // 2 :]))
