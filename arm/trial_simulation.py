"""A trial as a file has it, simulated in steps that are short enough and given back at the file's own samples."""

from collections.abc import Mapping

import numpy as np

from arm.drive_state import drives_of
from arm.effects.trials import AnyTrial
from arm.model import Arm, Floats
from arm.simulation import Motion, Scheme, simulate

#: The simulation's own step is at most this long [s].
LONGEST_STEP_S = 1e-3


def simulate_trial(
    arm: Arm,
    columns: Mapping[str, Floats],
    dt_s: float,
    q0: Floats,
    scheme: Scheme = "rk4",
    t0_s: float = 0.0,
    trial: AnyTrial = 1,
) -> Motion:
    """Simulate an arm under its law after ``ref``, or under ``tau`` where that law is "measured".

    Parameters
    ----------
    arm : Arm
    columns : mapping of str to ndarray of shape (n_sample, n_joint)
        By role: ``ref`` or ``tau``, and where they are known ``dq``, whose first row is where the arm starts, and
        the drives' ``on``, ``kp``, ``kv``.
    dt_s : float
        Interval of the samples.
    q0 : (n_joint,)
        Joint positions at the first sample [rad or m].
    scheme, t0_s, trial
        As in `arm.simulation.simulate`.

    Returns
    -------
    Motion
        As many samples as the columns have.

    Raises
    ------
    ConfigError, DataError
        As `arm.simulation.simulate` does.
    """
    role = "tau" if arm.control.law == "measured" else "ref"
    n = len(columns[role])
    parts = max(1, int(np.ceil(dt_s / LONGEST_STEP_S - 1e-9)))
    held = np.repeat(np.arange(n), parts)
    torque = None
    if role == "tau":
        fine = np.arange(n * parts) / parts
        torque = np.column_stack([np.interp(fine, np.arange(n), column) for column in columns["tau"].T])
    ref = columns.get("ref", np.zeros((n, arm.n_joint)))[held]
    dq, drives = columns.get("dq"), drives_of(columns)
    motion = simulate(
        arm,
        ref,
        dt_s / parts,
        q0,
        None if dq is None else dq[0],
        scheme,
        torque,
        t0_s,
        trial,
        None if drives is None else drives.rows(held),
    )
    return type(motion)(**{name: values[::parts] for name, values in vars(motion).items()})
