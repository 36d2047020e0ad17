"""Having the kernels of a calibration compiled before a stream is listened to."""

from functools import cache

import numpy as np

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.kinematics import sensor_positions
from arm.model import Arm
from arm.simulation import Motion
from fitter.data.felt import Felt
from fitter.data.motions import Measured
from fitter.live.calibration import Calibration
from limbcal.compilation import said_when_compiling
from tracking.noise import Noise
from tracking.readings import Readings

#: The kernels are the same for every arm; two short motions are through with soonest.
_ARM = "dd-arm"
_NOISE_M_S2 = 2e-3
_BENCH = Bench(rate_hz=200.0, trial_s=2.0, learning=1, evaluating=1)


@cache
def warm_up() -> None:
    """Calibrate an arm of no interest, as a stream's motions are: to be compiled now, or taken from the cache."""
    with said_when_compiling("fitter"):
        arm = load_arm(_ARM)
        calibration, rng = Calibration(arm), np.random.default_rng(0)
        for motion, role in zip(motions(arm, _BENCH, seed=0), ("learn", "evaluate"), strict=True):
            positions = sensor_positions(arm, motion.q)
            columns = {"q": motion.q, "dq": motion.dq, "ddq": motion.ddq, "points": positions - positions[0]}
            felt = _felt(arm, motion, rng)
            calibration.add(Measured(role, "warm-up", 0, motion.t, columns, role=role, felt=felt))
        calibration.breed()
        calibration.learn_dynamics()
        for role in ("learn", "evaluate"):
            calibration.scores(role)


def _felt(arm: Arm, motion: Motion, rng: np.random.Generator) -> Felt:
    """Return what the sensors read of a motion."""
    force = specific_force(arm, motion.q, motion.dq, motion.ddq)
    readings = force.reshape(len(force), -1) + _NOISE_M_S2 * rng.standard_normal((len(force), force[0].size))
    noise = Noise(np.full(readings.shape[1], _NOISE_M_S2**2), np.zeros(readings.shape[1]))
    dt_s = 1.0 / _BENCH.rate_hz
    return Felt(Readings(readings, dt_s, 0.0, noise, 1), motion.t, motion.q[0], motion.q[-1], None)
