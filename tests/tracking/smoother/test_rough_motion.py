"""A rough motion is near whatever a sensor gets wrong."""

import numpy as np

from arm.model import Arm
from tests.tracking.model.test_clocks import RATE_HZ, felt, read
from tracking.model.initial_state import MountingPrior
from tracking.smoother.coarsening import every
from tracking.smoother.rough_motion import rough_motion


def test_one_sensors_fault_bends_it_little(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    wrong = readings.copy()
    wrong[:, 9:12] *= 1.3
    found = rough_motion(vertical_arm, read(wrong), q[0], True)
    assert found is not None and found.is_near
    assert found.stride == round(RATE_HZ / 30.0)
    off = found.states[:, :6:3] - every(q, found.stride)[: len(found.states)]
    assert np.abs(off).max() < 0.3 and np.sqrt(np.mean(off**2)) < 0.1


def test_a_sound_arm_is_likelier_than_one_with_a_fault(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    sound = rough_motion(vertical_arm, read(readings), q[0], True)
    readings[:, 9:12] *= 1.3
    wrong = rough_motion(vertical_arm, read(readings), q[0], True)
    assert sound is not None and wrong is not None
    assert sound.log_likelihood > wrong.log_likelihood + 100.0


def test_mountings_that_are_right_are_near_wherever_sensors_sit(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    found = rough_motion(vertical_arm, read(readings), q[0], True, MountingPrior())
    assert found is not None and found.is_near
