"""Diagnosing sensors that nothing is wrong with on hardly any data, so that the kernels are compiled."""

import numpy as np

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import Bench, motions
from fitter.data.raw import RawRun
from fitter.reading_diagnosis.rigidity import diagnose_sensors

#: A motion to learn from and one to judge by.
_BENCH = Bench(rate_hz=200.0, trial_s=2.0, learning=1, evaluating=1)
_NOISE_M_S2 = 0.02


def warm_up() -> None:
    """Diagnose an arm of no interest."""
    arm, rng = load_arm("dd-arm-vertical"), np.random.default_rng(0)
    runs = []
    for motion in motions(arm, _BENCH, seed=0):
        felt = specific_force(arm, motion.q, motion.dq, motion.ddq).reshape(len(motion.t), -1)
        felt += _NOISE_M_S2 * rng.standard_normal(felt.shape)
        runs.append(RawRun("warm-up", _BENCH.rate_hz, motion.t, felt))
    diagnose_sensors(arm, runs[:1], runs[1:])
