"""The paper's own integration, as section 7 prints it."""

import numpy as np

from arm.chain import Chain
from arm.drive import Commands
from arm.effects.effect_table import EffectTable
from arm.integration import record
from arm.model import Floats
from arm.motion_equations import acceleration, equations
from arm.resistance import friction_alone
from arm.room import Room
from arm.sticking import choose_modes
from limbcal.compiled import compiled


@compiled
def paper_steps(
    chain: Chain,
    commands: Commands,
    effects: EffectTable,
    room: Room,
    state: Floats,
    motion: Floats,
    lead: Floats,
) -> None:
    """Fill in a motion by Runge-Kutta on the velocity alone, then Euler on the angle; ``effects`` must be none."""
    n_sample, n = commands.drive.shape
    dt = commands.dt
    friction_alone(chain, effects, room)
    q, dq, mode, trial = state[0].copy(), state[1].copy(), np.zeros(n), np.empty(n)
    slope, part = np.empty((4, n)), (0.0, 0.5, 0.5, 1.0)
    for k in range(n_sample):
        for stage in range(4):
            for i in range(n):
                trial[i] = dq[i] + part[stage] * dt * slope[max(stage - 1, 0), i] if stage else dq[i]
            equations(chain, commands, effects, k, 0.0, 0.0, q, trial, mode, room)  # theta is frozen in the step
            choose_modes(trial, mode, room, slope[stage])
            acceleration(mode, room, slope[stage])
        record(commands, effects, room, k, q, dq, slope[0], motion, lead)
        for i in range(n):
            dq[i] += dt / 6.0 * (slope[0, i] + 2.0 * slope[1, i] + 2.0 * slope[2, i] + slope[3, i])
            q[i] += dt * dq[i]  # theta^(t+1) = theta^t + dtheta^(t+1) h
