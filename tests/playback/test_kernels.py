"""What `limbplay compile` goes through is all that a motion and a touched arm need."""

import sys

import numpy as np
from numba.core.dispatcher import Dispatcher

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions, tip_position
from arm.simulation import simulate
from playback.kernels import compile_all
from playback.touch.grip import Hand
from playback.touch.limit import Coupling
from playback.touch.touched_arm import TouchedArm


def kernels() -> dict[str, Dispatcher]:
    """Return every kernel that was loaded."""
    return {
        f"{name}.{kernel.py_func.__name__}": kernel
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] in ("arm", "playback")
        for kernel in vars(module).values()
        if isinstance(kernel, Dispatcher)
    }


def signatures() -> dict[str, int]:
    return {name: len(kernel.signatures) for name, kernel in kernels().items()}


def test_nothing_is_left_to_compile() -> None:
    for kernel in kernels().values():  # what other tests compiled does not count
        kernel._reset_overloads()
    compile_all()
    before = signatures()
    arm, q0 = load_arm("dd-arm-vertical"), np.array([0.4, -0.3])
    motion = simulate(arm, np.zeros((20, 2)), 2e-3, q0)
    assert tip_position(arm, motion.q).shape == (20, 3)
    assert sensor_positions(arm, motion.q).shape == (20, len(arm.sensors), 3)
    touched = TouchedArm(arm, q0, 1e-3, Coupling())
    touched.take(touched.tip, Hand(touched.touched_point(touched.tip), None, np.eye(3)))
    touched.step(2, Hand(touched.touched_point(touched.tip) + 0.01, None, np.eye(3)))
    touched.step(1)
    assert signatures() == before
