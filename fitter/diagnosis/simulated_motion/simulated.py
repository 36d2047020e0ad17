"""The motion of an arm with its effects, driven as in a trial."""

import numpy as np

from arm.effects.effect_table import ROTOR, changed, effect_table
from arm.model import Arm, Floats
from arm.newton_euler import mass_matrix
from arm.simulation import simulate
from fitter.diagnosis.motion import Motion

#: The first state of a trial at rest is the mean over this long [s].
_REST_S = 0.04


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
