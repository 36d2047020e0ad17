"""The frames of `limb/play` that a touched arm sends."""

import time

import numpy as np

from arm.chain import chain_of
from arm.kinematics import frames_of
from arm.model import Floats
from playback.touch.touched_arm import TouchedArm

#: Frames of `limb/play` a second [Hz]: more than a screen shows, a tenth of the loop's rate.
FRAME_RATE_HZ = 100.0


class FrameStream:
    """The fields of `limb/play`, from arrays that are made once."""

    def __init__(self, touched: TouchedArm) -> None:
        self._touched = touched
        self._chain = chain_of(touched.arm)
        self._last = touched.arm.joints[-1].a_m
        sensors = touched.arm.sensors
        self._rides = np.array([sensor.joint - 1 for sensor in sensors], dtype=np.int64)
        self._places = np.array([sensor.position_m for sensor in sensors]).reshape(-1, 3, 1)

    def frame(self, k: int, felt: Floats, point: Floats) -> dict[str, object]:
        """Return frame ``k``, with what the hand feels (2, 3) and where the touched point is (3,)."""
        state = self._touched.state
        frames = frames_of(self._chain, state[:1])
        ends = frames[:, -1, :3, 3] + self._last * frames[:, -1, :3, 0]
        T = frames[0, self._rides]
        points = (T[:, :3, :3] @ self._places)[..., 0] + T[:, :3, 3]
        return {
            "frame0": k,
            "t0_ns": time.time_ns(),
            "dt_s": 1.0 / FRAME_RATE_HZ,
            "n": 1,
            "method": "simulate",
            "q": state[:1],
            "dq": state[1:2],
            "ddq": state[2:],
            "tip": ends,
            "points": points[None],
            "gap": False,
            "source": "touch",
            "speed": 1.0,
            "trial": 0,
            "position_s": k / FRAME_RATE_HZ,
            "point": point,
            "force": felt[0],
            "moment": felt[1],
        }
