"""Having the kernels of a calibration compiled before a stream is listened to."""

from collections.abc import Iterator
from functools import cache

import numpy as np

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.kinematics import sensor_positions
from arm.model import Arm
from fitter.data.felt import STEP_S, Felt
from fitter.data.motions import Measured
from fitter.live.calibration import Calibration
from limbcal.compilation import said_when_compiling
from tracking.model.noise import Noise
from tracking.model.readings import Readings

#: The kernels are the same for every arm; a few short motions are through with soonest.
_ARM = "dd-arm"
_BENCH = Bench(rate_hz=1.0 / STEP_S, trial_s=2.0, learning=2, evaluating=1)
_NOISE_M_S2, _SAMPLES = 0.02, 128


@cache
def warm_up() -> None:
    """Calibrate an arm of no interest, as a stream's motions are: to be compiled now, or taken from the cache."""
    with said_when_compiling("fitter"):
        arm = load_arm(_ARM)
        calibration = Calibration(arm)
        for motion in _motions(arm):
            calibration.add(motion)
        calibration.breed()
        calibration.learn_dynamics()
        for role in ("learn", "evaluate"):
            calibration.scores(role)


def _motions(arm: Arm) -> Iterator[Measured]:
    """Yield motions as they are cut out of a stream, with what the sensors read."""
    rng = np.random.default_rng(0)
    for k, motion in enumerate(motions(arm, _BENCH, seed=0)):
        positions = sensor_positions(arm, motion.q)
        columns = {"q": motion.q, "dq": motion.dq, "ddq": motion.ddq, "points": positions - positions[0]}
        read = specific_force(arm, motion.q, motion.dq, motion.ddq).reshape(len(motion.t), -1)
        variance = np.full(read.shape[1], _NOISE_M_S2**2)
        values = read + rng.normal(scale=_NOISE_M_S2 / np.sqrt(_SAMPLES), size=read.shape)
        readings = Readings(values, STEP_S, 0.0, Noise(variance, np.zeros_like(variance)), _SAMPLES)
        std = np.full(arm.n_joint, 0.01)
        felt = Felt(readings, motion.t, motion.q[0], motion.q[-1], std)
        role = "learn" if k < _BENCH.learning else "evaluate"
        yield Measured(f"warm-up {k}", "warm-up", 0, motion.t, columns, role=role, felt=felt)
