"""How far and how fast the joints of a table move, and what its angles leave unexplained of torque and tip."""

import numpy as np
from numpy.typing import NDArray

from arm.control import control_torque
from arm.drive_state import drives_of
from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.data.motions import Measured
from protocol.tables.columns import DRIVE_ROLES
from protocol.tables.turning import ROWS

#: Von Neumann's ratio from which on samples are independent rather than of one motion.
_INDEPENDENT = 0.5
#: Correlation beyond which a rate is that of a joint, whatever its unit and sign: two thirds of the variance.
_ALIKE = 0.8


def turning(arm: Arm) -> NDArray[np.bool_]:
    """Return which joints turn, (n_joint,)."""
    return np.array([joint.type == "revolute" for joint in arm.joints])


def continuous(q: Floats) -> bool:
    """Return whether angles are samples of a motion, and not poses that were measured one by one.

    By von Neumann's ratio (1941), the mean squared difference of neighbours over twice the variance: near 1 for
    independent samples, near 0 for a motion. A joint that wraps or stands still says nothing of the others.
    """
    if len(q) < 3:
        return False
    variance = np.var(q, axis=0)
    moves = variance > 0.0
    ratio = np.mean(np.diff(q, axis=0) ** 2, axis=0)[moves] / (2.0 * variance[moves])
    return bool(not moves.any() or ratio.min() < _INDEPENDENT)


def path_lengths(values: Floats) -> Floats:
    """Return how far columns move to and fro in all, (n_column,), their noise averaged out."""
    return np.asarray(np.abs(np.diff(thinned(values), axis=0)).sum(axis=0), dtype=np.float64)


def thinned(values: Floats) -> Floats:
    """Return means over blocks of rows, about `ROWS` of them."""
    block = max(1, len(values) // ROWS)
    n = len(values) // block
    return np.asarray(values[: n * block].reshape(n, block, *values.shape[1:]).mean(axis=1), dtype=np.float64)


def rate_ratio(motion: Measured, of: str, rate: str) -> Floats | None:
    """Return every joint's given rate over the slope of what it is of, (n_joint,): 1 where they agree.

    Least squares through zero; NaN where a joint hardly moves or the two are not alike at all. Below zero they
    count opposite ways.

    Parameters
    ----------
    motion : Measured
    of, rate : str
        Roles: ``q`` and ``dq``, or ``dq`` and ``ddq``.

    Returns
    -------
    ndarray or None
        None where the motion has not both.
    """
    if of not in motion.columns or rate not in motion.columns or len(motion.t) < 3:
        return None
    given = motion.columns[rate][1:-1]
    t, x = motion.t, motion.columns[of]
    slope = (x[2:] - x[:-2]) / (t[2:] - t[:-2])[:, None]
    power, cross, own = np.sum(slope**2, axis=0), np.sum(slope * given, axis=0), np.sum(given**2, axis=0)
    alike = np.abs(cross) > _ALIKE * np.sqrt(power * own)
    ok = (power > 0.0) & alike
    return np.where(ok, cross / np.where(ok, power, 1.0), np.nan)


def torque_residual(arm: Arm, motion: Measured, angle_scale: Floats) -> Floats | None:
    """Return what the best inertias leave of each joint's torque, as a fraction of its power, (n_joint,).

    Every joint's torque counts in units of its own size, so that a wrist's is heard beside a shoulder's.

    Parameters
    ----------
    arm : Arm
        Its geometry, gravity and law.
    motion : Measured
    angle_scale : ndarray of shape (n_joint,)
        What the positions of each joint are multiplied by.

    Returns
    -------
    ndarray or None
        NaN for a joint without torque; None where there is neither a torque nor a law with its target.
    """
    torque = drawn_torque(arm, motion, angle_scale)
    if torque is None:
        return None
    W, tau = torque
    power = np.sum(tau**2, axis=0)
    felt = power > 0.0
    if not felt.any():
        return None
    weight = 1.0 / np.sqrt(np.where(felt, power, np.inf))
    rows, wanted = np.concatenate(weight[:, None] * W), (weight * tau).ravel()
    size = np.linalg.norm(rows, axis=0)
    rows = rows[:, size > 0.0] / size[size > 0.0]
    if not rows.size:
        return None
    rest = (wanted - rows @ np.linalg.lstsq(rows, wanted, rcond=1e-6)[0]).reshape(tau.shape)
    return np.where(felt, np.sum(rest**2, axis=0), np.nan)


def drawn_torque(arm: Arm, motion: Measured, angle_scale: Floats) -> tuple[Floats, Floats] | None:
    """Return the regressor (n, n_joint, 12 n_joint) and the torque (n, n_joint) of a thinned table, or None.

    Parameters
    ----------
    arm : Arm
        Its geometry, gravity and law.
    motion : Measured
    angle_scale : ndarray of shape (n_joint,)
        What the positions of each joint are multiplied by.
    """
    columns = motion.columns
    t, q = thinned(motion.t), angle_scale * thinned(columns["q"])
    if len(t) < 8:
        return None
    dq = np.gradient(q, t, axis=0)
    ddq = np.gradient(dq, t, axis=0)
    if arm.control.law == "measured":
        if "tau" not in columns:
            return None
        tau = thinned(columns["tau"])
    elif "ref" in columns:
        ref = angle_scale * thinned(columns["ref"])
        drives = drives_of({role: thinned(columns[role]) for role in DRIVE_ROLES if role in columns})
        law = arm.control
        tau = control_torque(law, q, dq, ddq, ref) if drives is None else drives.torque(law, q, dq, ddq, ref)
    else:
        return None
    return regressor(arm, q, dq, ddq), tau


def reach(arm: Arm) -> float:
    """Return how far an arm reaches by its file [m]; 0 where it knows no length."""
    return float(sum(np.hypot(joint.a_m, joint.d_m) for joint in arm.joints))
