"""The torque that an arm's effects add to that of its rigid links and plain friction, along a motion."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.chain import motion_rows
from arm.effects.catalogue import catalogue
from arm.effects.effect import number
from arm.effects.effect_table import changed
from arm.effects.joint_numbers import ROTOR
from arm.effects.joint_torque import COULOMB, DIRECTION, DQ, N_STATE, TAU, VISCOUS, Q, T, torque_along
from arm.effects.payload import with_load
from arm.effects.trials import AnyTrial, acts_from, acts_in
from arm.model import Arm, Floats
from arm.moving_base import BaseState, carried_inverse_dynamics
from arm.newton_euler import inverse_dynamics
from limbcal.errors import DataError


def resisting_torque(
    arm: Arm,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    u: Floats,
    t: Floats,
    trial: AnyTrial = 1,
    direction: Floats | None = None,
    base: BaseState | None = None,
) -> Floats:
    """Return the sum of the effects that act at joints, of rotors and of payloads.

    Parameters
    ----------
    arm : Arm
        With its effects.
    q, dq, ddq : (n_sample, n_joint) [rad or m, and derivatives]
        Of the links.
    u : (n_sample, n_joint) [N m or N]
        Torque that drives the joints, after the drive's effects.
    t : (n_sample,) [s]
        The run's time.
    trial : int or TrialId
        Its number in the run, or what effects call it.
    direction : (n_sample, n_joint), optional
        In which the joints move, or would; the sign of ``dq`` unless given.
    base : BaseState, optional
        What carries frame 0, and with it a payload; it stands unless given.

    Returns
    -------
    (n_sample, n_joint) [N m or N]
        Counted as friction is: what must drive the joint beyond the rigid arm and plain friction.

    Raises
    ------
    ConfigError
        If an effect is not as the catalogue has it.
    DataError
        If shapes don't fit.
    """
    q, dq, ddq, u = motion_rows(arm, q=q, dq=dq, ddq=ddq, u=u)
    if np.shape(t) != (len(q),):
        raise DataError(f"t has shape {np.shape(t)}, expected ({len(q)},)")
    arm, way = changed(arm), np.sign(dq) if direction is None else direction
    total = np.zeros_like(q)
    for effect in arm.effects:
        kind, values = catalogue()[effect.name], effect.parameters
        if not acts_in(values, trial):
            continue
        for i in (joint - 1 for joint in effect.joints):
            if kind.torque is not None:
                friction = arm.joints[i].friction
                states = np.empty((len(q), N_STATE))
                states[:, T], states[:, Q], states[:, DQ], states[:, TAU] = t, q[:, i], dq[:, i], u[:, i]
                states[:, DIRECTION] = way[:, i]
                states[:, VISCOUS], states[:, COULOMB] = friction.viscous_N_m_s, friction.coulomb_N_m
                numbers = np.array([number(values, parameter.name) for parameter in kind.numbers])
                total[:, i] += torque_along(kind, numbers, states)
            elif ROTOR in kind.simulated:
                total[:, i] += number(values, kind.simulated[ROTOR]) * ddq[:, i]
        if kind.tip_mass:
            there = t >= acts_from(values, trial)
            total += _load(arm, q, dq, ddq, number(values, kind.tip_mass), there, base)
    return total


def _load(
    arm: Arm,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    mass_kg: float,
    on: NDArray[np.bool_],
    base: BaseState | None,
) -> Floats:
    """Return the torque that a mass at the tip adds where it is there."""
    plain = replace(arm, effects=())
    loaded = with_load(plain, mass_kg)
    if base is None:
        added = inverse_dynamics(loaded, q, dq, ddq) - inverse_dynamics(plain, q, dq, ddq)
    else:
        with_it, without = (carried_inverse_dynamics(one, q, dq, ddq, base) for one in (loaded, plain))
        added = with_it - without
    return np.where(on[:, None], added, 0.0)
