"""An arm that a segment carries, and a motion of both."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm
from arm.model import Base, Marker


@pytest.fixture
def carried():
    arm = load_arm("human-arm-right")
    markers = tuple(Marker(f"M{k}", k, (0.01 * k, 0.02, -0.1)) for k in range(arm.n_joint + 1))
    return replace(arm, base=Base((0.02, -0.1, 0.3), (0.2, -0.4, 0.7), "thorax"), markers=markers)


@pytest.fixture
def motion(carried):
    rng = np.random.default_rng(0)
    turns = Rotation.from_rotvec(0.4 * rng.normal(size=(9, 3))).as_quat()
    base = np.hstack([rng.normal(size=(9, 3)), turns[:, [3, 0, 1, 2]]])
    return np.arange(9) / 50.0 + 2.0, 0.5 * rng.normal(size=(9, carried.n_joint)), base
