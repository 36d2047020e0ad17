"""Where the torque was on its way to the joints before the first sample."""

import numpy as np

from arm.drive import BEFORE, LAGGED0, PLAY0, TWIST0, Commands, Way
from arm.effects.effect_table import EffectTable
from arm.effects.joint_numbers import DELAY, FACTOR, GAP, LAG, LIMIT, STIFFNESS
from arm.effects.resisting_torque import resisting_torque
from arm.effects.trials import AnyTrial
from arm.model import Arm, Floats
from arm.newton_euler import bias_torque


def set_way(arm: Arm, commands: Commands, effects: EffectTable, trial: AnyTrial, state: Floats, way: Way) -> None:
    """Fill in what lags, play and twist were, and what the controller had asked for.

    An arm that rests at the first sample is taken to have rested before: its drives gave what holds it, and of
    that what is next to the first command. One that moves is taken to have had that command already.

    Parameters
    ----------
    arm : Arm
        As `changed` has it.
    commands : Commands
    effects : EffectTable
    trial : int or TrialId
    state : (2, n_joint)
        As it is measured at the first sample; becomes that of the links.
    way : Way
        Filled in.
    """
    q, dq = state
    target, (kp, kv, _), numbers = commands.drive[0], commands.law, effects.numbers
    asked = target if commands.given else kp * (target - q) + kv * dq
    before = asked.copy()
    late = (numbers[DELAY] > 0.0) | (numbers[LAG] > 0.0)
    if late.any() and not dq.any():
        before = np.where(late, _resting(arm, q, asked, numbers[FACTOR], commands.t0, trial), asked)
    torque = np.clip(numbers[FACTOR] * before, -numbers[LIMIT], numbers[LIMIT])
    x = way.state
    x[BEFORE], x[LAGGED0] = before, before
    x[PLAY0] = numbers[GAP] / 2.0 * np.sign(torque)
    x[TWIST0] = torque / numbers[STIFFNESS]
    q -= x[PLAY0] + x[TWIST0]


def _resting(arm: Arm, q: Floats, asked: Floats, factor: Floats, t: float, trial: AnyTrial) -> Floats:
    """Return the command next to ``asked`` under which a resting arm stays where it is."""
    still, torque, now = np.zeros((1, arm.n_joint)), (factor * asked)[None], np.array([t])
    forwards, backwards = (
        resisting_torque(arm, q[None], still, still, torque, now, trial, np.full_like(still, side))[0]
        for side in (1.0, -1.0)
    )
    friction = np.array([(j.friction.coulomb_N_m, j.friction.static_N_m) for j in arm.joints])
    hold = np.maximum(friction[:, 0] + (forwards - backwards) / 2.0, np.maximum(friction[:, 1], 0.0))
    centre = bias_torque(arm, q[None], still)[0] + (forwards + backwards) / 2.0
    held = np.clip(factor * asked, centre - hold, centre + hold)
    return np.divide(held, factor, out=asked.copy(), where=factor != 0.0)
