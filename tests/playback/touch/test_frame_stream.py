"""Frames of a touched arm hold what the geometry says."""

import time

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions, tip_position
from playback.touch.frame_stream import FrameStream
from playback.touch.limit import Coupling
from playback.touch.touched_arm import TouchedArm


@pytest.mark.parametrize("name", ["dd-arm", "spatial-arm"])
def test_a_frame_is_the_arm_at_one_instant(name: str) -> None:
    arm = load_arm(name)
    q = 0.3 + 0.2 * np.arange(arm.n_joint)
    touched = TouchedArm(arm, q, 1e-3, Coupling())
    felt, point = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]), np.array([0.1, 0.2, 0.3])
    before_ns = time.time_ns()
    frame = FrameStream(touched).frame(250, felt, point)
    assert before_ns <= int(str(frame["t0_ns"])) <= time.time_ns()
    for field, value in {
        **{"q": touched.state[:1], "dq": touched.state[1:2], "ddq": touched.state[2:]},
        **{"tip": tip_position(arm, q[None]), "points": sensor_positions(arm, q[None])},
        **{"point": point, "force": felt[0], "moment": felt[1]},
    }.items():
        np.testing.assert_allclose(np.asarray(frame[field]), value, atol=1e-12, err_msg=field)
        assert np.shape(frame[field]) == value.shape
    plain = {
        **{"frame0": 250, "n": 1, "dt_s": 0.01, "position_s": 2.5, "speed": 1.0, "trial": 0},
        **{"gap": False, "source": "touch", "method": "simulate"},
    }
    assert {field: frame[field] for field in plain} == plain
