"""Having the kernels of a calibration compiled before a stream is listened to."""

from functools import cache

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.kinematics import sensor_positions
from fitter.data.motions import Measured
from fitter.live.calibration import Calibration
from limbcal.compilation import said_when_compiling

#: The kernels are the same for every arm; two short motions are through with soonest.
_ARM = "dd-arm"
_BENCH = Bench(rate_hz=200.0, trial_s=2.0, learning=1, evaluating=1)


@cache
def warm_up() -> None:
    """Calibrate an arm of no interest, as a stream's motions are: to be compiled now, or taken from the cache."""
    with said_when_compiling("fitter"):
        arm = load_arm(_ARM)
        calibration = Calibration(arm)
        for motion, role in zip(motions(arm, _BENCH, seed=0), ("learn", "evaluate"), strict=True):
            positions = sensor_positions(arm, motion.q)
            columns = {"q": motion.q, "dq": motion.dq, "ddq": motion.ddq, "points": positions - positions[0]}
            calibration.add(Measured(role, "warm-up", 0, motion.t, columns, role=role))
        calibration.breed()
        calibration.learn_dynamics()
        for role in ("learn", "evaluate"):
            calibration.scores(role)
