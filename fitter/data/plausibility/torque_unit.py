"""Torque in thousandths of newton metres, or in newton millimetres, where newton metres are expected.

The torque equation is linear in masses, so no residual shows the unit: a thousand times the torque is a thousand
times the mass. Where gravity pulls at a joint the masses beyond it show, and lengths say what no arm of that size
can weigh. Inertia says nothing: a rotor behind a gear may exceed the arm's own by far. An arm that is light for
its size passes in N·mm as a heavy one, and is not asked about.
"""

import numpy as np

from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.data.motions import Measured
from fitter.data.plausibility.motion_sizes import drawn_torque, thinned, turning
from fitter.data.plausibility.refusal import Refusal
from protocol.tables.magnitude import EFFECTIVE_SAMPLES

#: Density of steel [kg/m³] (EN 1991-1-1).
_STEEL = 7850.0
#: First moment of the heaviest load an arm may have, over the fourth power of its reach [kg/m³]: a ball of solid
#: steel at its end, as thick as the arm is long.
_HEAVIEST = _STEEL * np.pi / 6.0
_MILLI = 1e-3
#: Gravity's torque counts by what exceeds this many of its standard errors.
_STANDARD_ERRORS = 2.0
#: What the data tells less of than this, as a fraction of what it tells most of, it does not tell; and torque is
#: explained no better than this fraction of its rms.
_RANK, _ROUNDING = 1e-7, 1e-6


def look(motion: Measured, arm: Arm) -> Measured:
    """Return the motion, or refuse it where the masses that its torque carries are too heavy for their size.

    Raises
    ------
    Refusal
        With the likely unit.
    """
    n, gravity = arm.n_joint, float(np.linalg.norm(arm.gravity_m_s2))
    stated = any(f"tau{j + 1}" in motion.stated for j in range(n))
    if arm.control.law != "measured" or stated or "q" not in motion.columns or not turning(arm).all():
        return motion
    torque = drawn_torque(arm, motion, np.ones(n))
    if torque is None:
        return motion
    carried = _carried(arm, thinned(motion.columns["q"]), *torque)
    reaches = _reaches(arm)
    j = int(np.argmax(carried))
    if not (carried[j] > 0.0 and reaches[j] > 0.0):  # nothing is carried without gravity
        return motion
    moment, heaviest = float(carried[j]) / gravity, _HEAVIEST * float(reaches[j]) ** 4
    if moment <= heaviest or _MILLI * moment > heaviest:
        return motion
    raise Refusal(
        f"{motion.where}: tau{j + 1} carries {carried[j]:.3g} N·m against gravity, at least "
        f"{moment / reaches[j]:.3g} kg on an arm that reaches {reaches[j]:.3g} m beyond joint {j + 1}, and a ball "
        "of solid steel as thick as that is lighter: is tau in N·mm or mN·m, or are lengths of the arm file too "
        'short? Expected N·m, or the unit stated, as in --columns "tau=tau{j}:N.mm" (tau=tau{j}:N.m if it is N·m)'
    )


def _reaches(arm: Arm) -> Floats:
    """Return how far from its axis the arm reaches beyond each joint at most [m], (n_joint,)."""
    lengths = np.array([np.hypot(joint.a_m, joint.d_m) for joint in arm.joints])
    own = np.abs([joint.a_m for joint in arm.joints])
    return np.asarray(own + np.cumsum(lengths[::-1])[::-1] - lengths, dtype=np.float64)


def _carried(arm: Arm, q: Floats, W: Floats, tau: Floats) -> Floats:
    """Return how much of each joint's torque carries weight for certain, at its largest [N m], (n_joint,).

    Less than nothing where even that it carries any is not certain.

    Least squares with each joint's torque in units of its residual, and `EFFECTIVE_SAMPLES` of it.
    """
    still = np.zeros_like(q)
    pulled = regressor(arm, q, still, still)
    pulled[..., 10 * arm.n_joint :] = 0.0  # friction that stands still is none of the weight
    size = np.linalg.norm(np.concatenate(W), axis=0)
    felt = size > 0.0
    W, pulled = W[..., felt] / size[felt], pulled[..., felt] / size[felt]
    power = np.sqrt(np.mean(tau**2, axis=0))
    heard = power > 0.0
    if not heard.any() or not felt.any():
        return np.zeros(arm.n_joint)
    W, tau, power = W[:, heard], tau[:, heard], power[heard]
    sigma = power
    for _ in range(2):  # in units of the torque itself at first
        U, s, Vt = np.linalg.svd(np.concatenate(W / sigma[:, None]), full_matrices=False)
        identifiable = s > _RANK * s[0]
        found = Vt[identifiable].T @ ((U.T @ (tau / sigma).ravel())[identifiable] / s[identifiable])
        sigma = np.maximum(np.sqrt(np.mean((tau - W @ found) ** 2, axis=0)), _ROUNDING * power)
    along = pulled @ Vt.T / np.maximum(s, _RANK * s[0])
    std = np.sqrt(max(1.0, len(tau) / EFFECTIVE_SAMPLES) * np.sum(along**2, axis=2))
    return np.asarray(np.max(np.abs(pulled @ found) - _STANDARD_ERRORS * std, axis=0), dtype=np.float64)
