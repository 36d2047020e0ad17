"""An arm's effects as plain arrays, which is all that the compiled simulation knows of them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.effects.catalogue import catalogue
from arm.effects.check import effect_mistakes
from arm.effects.effect import number
from arm.effects.joint_numbers import DAMPING, DELAY, FACTOR, GAP, LIMIT, N_NUMBER, STIFFNESS
from arm.effects.joint_torque import COULOMB, DIRECTION, MOST_PARAMETERS, N_STATE, TAU, VISCOUS, Q, T, torque_along
from arm.effects.trials import AnyTrial, acts_from, acts_in
from arm.model import Arm, Floats
from limbcal.compiled import compiled
from limbcal.errors import ConfigError

#: States at which an effect is asked whether it depends on the direction: two instants, two angles, two torques.
_PROBED = [(t, q, tau) for t in (1.0, 7.3) for q in (0.3, -1.1) for tau in (1.7, -0.6)]


class EffectTable(NamedTuple):
    """What acts in a simulation.

    Attributes
    ----------
    joint, address : (n_effect,) int
        Of each effect that acts at a joint: which one, and where its C function is.
    parameters : (n_effect, 4)
    directed : (n_joint,) bool
        Whether one of them depends on the direction in which the joint moves.
    numbers : (8, n_joint)
        Of each joint, as `arm.effects.joint_numbers` has them.
    driven : bool
        Whether something lies between the controller and the joint.
    geared : bool
        Whether something lies between the angle that is measured and that of the link.
    payload : (n_payload, 2)
        Since when [s], and how much [kg].
    """

    joint: NDArray[np.int64]
    address: NDArray[np.int64]
    parameters: Floats
    directed: NDArray[np.bool_]
    numbers: Floats
    driven: bool
    geared: bool
    payload: Floats


@compiled
def no_effects(n: int) -> EffectTable:
    """Return the table of an arm with ``n`` joints and no effects."""
    numbers = np.zeros((N_NUMBER, n))
    numbers[FACTOR], numbers[LIMIT], numbers[STIFFNESS] = 1.0, np.inf, np.inf
    return EffectTable(
        np.empty(0, dtype=np.int64),
        np.empty(0, dtype=np.int64),
        np.empty((0, MOST_PARAMETERS)),
        np.zeros(n, dtype=np.bool_),
        numbers,
        bool(n < 0),
        bool(n < 0),
        np.empty((0, 2)),
    )


def changed(arm: Arm) -> Arm:
    """Return the arm with those effects that are other numbers of the arm, its joints or its sensors.

    Raises
    ------
    ConfigError
        If an effect is not as the catalogue has it.
    """
    if arm.effects and (mistakes := effect_mistakes(arm)):
        raise ConfigError(mistakes)
    for effect in arm.effects:
        change = catalogue()[effect.name].change
        if change is not None:
            arm = change(arm, effect)
    return arm


def effect_table(arm: Arm, trial: AnyTrial = 1) -> EffectTable:
    """Return what acts in a simulation of one of a run's trials.

    Parameters
    ----------
    arm : Arm
        As `changed` has it.
    trial : int or TrialId
        Its number, or what effects call it.
    """
    none = no_effects(arm.n_joint)
    if not arm.effects:
        return none
    joint, address, parameters, payload = [], [], [], []
    directed, numbers = none.directed, none.numbers
    for effect in arm.effects:
        kind = catalogue()[effect.name]
        values = effect.parameters
        if not acts_in(values, trial):
            continue
        if kind.torque is not None:
            row = np.zeros(MOST_PARAMETERS)
            row[: len(kind.numbers)] = [number(values, parameter.name) for parameter in kind.numbers]
            for i in (j - 1 for j in effect.joints):
                states = _probes(arm.joints[i].friction.viscous_N_m_s, arm.joints[i].friction.coulomb_N_m)
                forwards, backwards = torque_along(kind, row, states).reshape(2, -1)
                directed[i] |= bool(np.any(forwards != backwards))
                joint.append(i)
                address.append(kind.torque.address)  # type: ignore[attr-defined]
                parameters.append(row)
        for place, name in kind.simulated.items():
            numbers[place, [j - 1 for j in effect.joints]] = number(values, name)
        if kind.tip_mass:
            payload.append((acts_from(values, trial), number(values, kind.tip_mass)))
    neutral = numbers == no_effects(arm.n_joint).numbers
    return EffectTable(
        np.array(joint, dtype=np.int64),
        np.array(address, dtype=np.int64),
        np.array(parameters, dtype=float).reshape(-1, MOST_PARAMETERS),
        directed,
        numbers,
        not neutral[DELAY : DAMPING + 1].all(),
        not neutral[GAP : DAMPING + 1].all(),
        np.array(sorted(payload), dtype=float).reshape(-1, 2),
    )


def _probes(viscous: float, coulomb: float) -> Floats:
    """Return states of a joint that starts to move, first forwards and then backwards."""
    states = np.zeros((2, len(_PROBED), N_STATE))
    states[:, :, [T, Q, TAU]] = _PROBED
    states[:, :, VISCOUS], states[:, :, COULOMB] = viscous, coulomb
    states[0, :, DIRECTION], states[1, :, DIRECTION] = 1.0, -1.0
    return states.reshape(-1, N_STATE)
