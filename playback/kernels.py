"""Going through what playback does, so that all kernels are compiled."""

import numpy as np

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions, tip_position
from arm.simulation import simulate
from playback.touch.loop import Setup
from playback.touch.loop_process import warmed_up

#: Length [s] and number of the steps that are simulated: any will do.
_STEP_S, _STEPS = 1e-3, 10


def compile_all() -> None:
    """Simulate, place and touch an arm of no interest."""
    arm = load_arm("dd-arm")
    motion = simulate(arm, np.zeros((_STEPS, arm.n_joint)), _STEP_S, np.zeros(arm.n_joint))
    tip_position(arm, motion.q)
    sensor_positions(arm, motion.q)
    warmed_up(Setup(arm, (0.0,) * arm.n_joint, 1.0 / _STEP_S))
